"""What the modeller of a frame has: matrices of a coarser mesh, a part for each bar, a node table with node sets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.io import mmwrite

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.matrices_model import write_nodes, write_parts

DIRECTIONS = (3, 5, 4)
"""UFF direction of w, of p = dw/dx, which is less the rotation about y, and of q = dw/dy, that about x."""

SIGNS = (1.0, -1.0, 1.0)


def write_frame_model(drawn: Frame, elements: int, folder: Path) -> dict[str, Any]:
    """Write a frame as drawn, on so many elements a bar, as matrices; return the study's ``[model]``."""
    frame = replace(drawn, elements=elements, attached=())
    free = frame.free
    signs = np.tile(SIGNS, len(frame.mesh.places))

    def write(name: str, matrix: FloatArray) -> str:
        own = (signs[:, None] * matrix * signs)[np.ix_(free, free)]
        mmwrite(folder / f"{name}.mtx", sparse.coo_array(own), precision=17)
        return f"{name}.mtx"

    write_nodes(folder, _nodes(frame))
    return write_parts(write, frame.matrices[:2], frame.parts())


def _nodes(frame: Frame) -> Iterator[tuple[int, str, int, int | str, str]]:
    """Yield the lines of the node table; joints name their two sides, feet themselves."""
    named: dict[int, str] = {node: name for name, node in frame.held.items()}
    for name, (rail, rung) in frame.mesh.joints.items():
        named |= {rail: f"{name}_rail", rung: f"{name}_rung"}
    row_of = {row: i for i, row in enumerate(frame.free, start=1)}
    for node, (x, y) in enumerate(frame.mesh.places.tolist()):
        for i, direction in enumerate(DIRECTIONS):
            yield node, f"{x:.9g}, {y:.9g}, 0", direction, row_of.get(3 * node + i, ""), named.get(node, "")
