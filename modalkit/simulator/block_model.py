"""What the modeller of a ribbed plate or a bracket has: matrices of CalculiX on a coarser mesh, part by part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from modalkit.simulator.bodies.block.assembled import Matrix
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.matrices_model import write_nodes, write_parts


def write_block_model(drawn: Block, elements: int, folder: Path) -> dict[str, Any]:
    """Write a body as drawn, with so many bricks along it, as matrices; return the study's ``[model]``."""
    block = replace(drawn, elements=elements, attached=())
    moves = block.free()

    def write(name: str, matrix: Matrix) -> str:
        sparse.save_npz(folder / f"{name}.npz", Matrix(moves.T @ matrix @ moves))
        return f"{name}.npz"

    write_nodes(folder, _nodes(block, moves))
    return write_parts(write, block.material(), block.parts())


def _nodes(block: Block, moves: Matrix) -> Iterator[tuple[int, str, int, int | str, str]]:
    """Yield the lines of the node table; bolts name their two sides, feet themselves."""
    bricks = block.bricks
    sets: dict[int, str] = {int(node): name for name, nodes in bricks.feet.items() for node in nodes}
    for name, sides in bricks.bolts.items():
        for side, nodes in zip(("plate", "flange"), sides, strict=True):
            sets |= {int(node): f"{name}_{side}" for node in nodes}
    row_of = {int(row): i for i, row in enumerate(moves.tocsc().indices, start=1)}
    for node, at in enumerate(bricks.mesh.nodes[1].tolist()):
        place = ", ".join(f"{c:.9g}" for c in np.add(at, [block.start, 0.0, 0.0]))
        for axis in range(3):
            yield node, place, axis + 1, row_of.get(3 * node + axis, ""), sets.get(node, "")
