"""Matrices as text that names nodes and directions, of Abaqus and of Nastran, written for the tests."""

from __future__ import annotations

from pathlib import Path

from imported_cases import LENGTH

from updating.models.fields import Sparse

ELEMENTS = 6
LABELS = [(10 * (i // 2 + 1), 3 if i % 2 == 0 else 5) for i in range(2 * (ELEMENTS + 1))]
"""Node and direction of every row of the free beam."""


def lower(matrix: Sparse) -> list[tuple[int, int, float]]:
    dense = matrix.toarray()
    return [(i, j, dense[i, j]) for i in range(len(dense)) for j in range(i + 1) if dense[i, j]]


def abaqus(path: Path, matrix: Sparse, held: tuple[int, ...] = ()) -> Path:
    """Write one triangle as Abaqus does: supports keep their diagonal, 1e36."""
    lines = [
        "{},{}, {},{}, {:.15e}".format(*LABELS[i], *LABELS[j], value)
        for i, j, value in lower(matrix)
        if i not in held and j not in held
    ]
    lines += ["{},{}, {},{}, 1.000000000000000e+36".format(*LABELS[i], *LABELS[i]) for i in held]
    path.write_text("\n".join(lines) + "\n")
    return path


def punched(path: Path, **matrices: Sparse) -> Path:
    """Write matrices as Nastran punches them: a line for each column, and for each entry in large fields."""
    lines = ["$ a comment", "GRID*                 10               0 0.0             0.0             "]
    for name, matrix in matrices.items():
        lines.append(f"DMIG    {name:<8}       0       6       2       0               {matrix.shape[0]:8d}")
        last = -1
        for i, j, value in sorted(lower(matrix), key=lambda entry: entry[1]):
            if j != last:
                lines.append(f"DMIG*   {name:<16}{LABELS[j][0]:16d}{LABELS[j][1]:16d}")
                last = j
            number = f"{value:16.9E}".replace("E", "D")
            lines.append(f"*       {LABELS[i][0]:16d}{LABELS[i][1]:16d}{number}")
    path.write_text("\n".join([*lines, "$", "ENDDATA"]) + "\n")
    return path


def places(path: Path, *more: str) -> Path:
    rows = [
        f"{10 * (i + 1)}, {LENGTH * i / ELEMENTS!r}, 0, 0, {'tip' if i == ELEMENTS else ''}"
        for i in range(ELEMENTS + 1)
    ]
    path.write_text("\n".join(["node, x, y, z, sets", *rows, *more]) + "\n")
    return path
