"""What the modeller of a frame has: matrices of a coarser mesh, a part for each bar, a node table with node sets."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.io import mmwrite

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.frame.frame import Frame

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

    stiffness, mass, *_ = frame.matrices
    parts = frame.parts()
    (folder / "nodes.csv").write_text(_table(frame), encoding="ascii")
    return {
        "type": "matrices",
        "stiffness": write("stiffness", stiffness),
        "mass": write("mass", mass),
        "nodes": "nodes.csv",
        "stiffness_parts": [write(f"stiffness_{name}", k) for name, (k, _) in parts.items()],
        "mass_parts": [write(f"mass_{name}", m) for name, (_, m) in parts.items()],
    }


def _table(frame: Frame) -> str:
    """Return the node table; joints name their two sides, feet themselves."""
    named: dict[int, str] = {node: name for name, node in frame.held.items()}
    for name, (rail, rung) in frame.mesh.joints.items():
        named |= {rail: f"{name}_rail", rung: f"{name}_rung"}
    row_of = {row: i for i, row in enumerate(frame.free, start=1)}
    lines = ["node, x, y, z, direction, row, sets"]
    for node, (x, y) in enumerate(frame.mesh.places.tolist()):
        for i, direction in enumerate(DIRECTIONS):
            row = row_of.get(3 * node + i, "")
            lines.append(f"{node + 1}, {x:.9g}, {y:.9g}, 0, {direction}, {row}, {named.get(node, '')}")
    return "\n".join(lines) + "\n"
