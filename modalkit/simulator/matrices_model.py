"""Matrices, part by part, and a node table: what the modeller of a body of named parts has."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

M = TypeVar("M")
"""A matrix: dense, or sparse."""


def write_parts(
    write: Callable[[str, M], str], whole: tuple[M, M], parts: Mapping[str, tuple[M, M]]
) -> dict[str, Any]:
    """Write stiffness and mass of a body and of its parts; return the study's ``[model]``, its nodes in ``nodes.csv``.

    Parameters
    ----------
    write : callable
        Takes a name and a matrix to the file that it wrote.
    whole : (stiffness, mass)
        Of the body.
    parts : mapping of str to (stiffness, mass)
        Of its parts.
    """
    return {
        "type": "matrices",
        "stiffness": write("stiffness", whole[0]),
        "mass": write("mass", whole[1]),
        "nodes": "nodes.csv",
        "stiffness_parts": [write(f"stiffness_{name}", k) for name, (k, _) in parts.items()],
        "mass_parts": [write(f"mass_{name}", m) for name, (_, m) in parts.items()],
    }


def write_nodes(folder: Path, lines: Iterable[tuple[int, str, int, int | str, str]]) -> None:
    """Write the node table.

    Parameters
    ----------
    folder : Path
        Of the study.
    lines : iterable of (node, place, direction, row, sets)
        Node from 0, "x, y, z" [m], direction as in a UFF, row from 1 or nothing where it is held, and node sets.
    """
    table = [
        f"{node + 1}, {place}, {direction}, {row}, {sets}" for node, place, direction, row, sets in lines
    ]
    (folder / "nodes.csv").write_text(
        "\n".join(["node, x, y, z, direction, row, sets", *table]) + "\n", encoding="ascii"
    )
