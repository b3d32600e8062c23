"""Matrices whose entries name nodes and directions in place of rows: Abaqus' text output, Nastran's punched DMIG.

Abaqus writes ``row node, direction, column node, direction, value`` under ``*MATRIX OUTPUT, FORMAT=MATRIX INPUT`` (its
default); a degree of freedom that a boundary condition holds has 1e36 on the diagonal. Nastran punches ``DMIG``
entries in large fields of 16 columns: a column of the matrix with node and direction, then a line for each entry.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.naming import chosen
from updating.models.imported.numerals import NUMBER, columns_of

HELD_BY = 1e30
"""From this stiffness on Abaqus means a support: it writes 1e36, and no structure comes near [its unit]."""

PUNCHED = (".pch", ".dmig")
"""Endings of Nastran's files."""

FIELD = 16
"""Columns of a large field; the first is half as wide."""

CARD = 80
"""Columns of a line."""

SYMMETRIC, SQUARE, REAL = "6", "1", ("1", "2")
"""What form and type of a DMIG header may be."""


@dataclass(frozen=True, eq=False)
class Labelled:
    """Entries of a matrix by the nodes and directions of their rows and columns.

    Parameters
    ----------
    row, column : (n, 2) int arrays
        Node and direction.
    value : (n,) array
        The entries [as in the file].
    source : str
        File, for messages.
    """

    row: IntArray
    column: IntArray
    value: FloatArray
    source: str

    def on(self, labels: dict[tuple[int, int], int]) -> Sparse:
        """Return the matrix on rows (labels to numbers from 0); entries of others are left out."""
        size = len(labels)
        at = [
            np.array([labels.get((n, d), -1) for n, d in of.tolist()], dtype=np.int64)
            for of in (self.row, self.column)
        ]
        kept = (at[0] >= 0) & (at[1] >= 0)
        matrix = Sparse(
            sparse.coo_array((self.value[kept], (at[0][kept], at[1][kept])), (size, size)).tocsr()
        )
        upper, lower = (Sparse(cut(matrix, k)).nnz for cut, k in ((sparse.triu, 1), (sparse.tril, -1)))
        if upper and lower:
            return matrix
        return Sparse(matrix + matrix.T - sparse.diags_array(matrix.diagonal()))


def is_labelled(path: Path) -> bool:
    """Return whether a file is of this kind: by its ending, or a first line of five numbers between commas."""
    if path.suffix.lower() in PUNCHED:
        return True
    if path.suffix.lower() != ".mtx" or not path.is_file():
        return False
    with path.open("rb") as file:
        return file.readline(200).count(b",") == 4


def read_labelled(path: Path, kind: str, name: str | None = None) -> Labelled:
    """Read a matrix; of a punched file that of a name, or of the kind, ``stiffness`` or ``mass``, by K or M.

    Raises
    ------
    StudyError
        If the file cannot be read, or holds no such matrix or several.
    """
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    return _punched(path, kind, name) if path.suffix.lower() in PUNCHED else _of_abaqus(path)


def rows_of(matrices: Sequence[Labelled]) -> tuple[dict[tuple[int, int], int], list[tuple[int, int]]]:
    """Return the rows that a stiffness, the first, and its companions have, and what supports hold.

    Returns
    -------
    rows : dict of (node, direction) to int
        From 0, sorted.
    held : list of (node, direction)
        Degrees of freedom with the stiffness of a support.
    """
    every = {(n, d) for one in matrices for of in (one.row, one.column) for n, d in of.tolist()}
    stiffness = matrices[0]
    stiff = (stiffness.row == stiffness.column).all(axis=1) & (stiffness.value > HELD_BY)
    held = sorted({(n, d) for n, d in stiffness.row[stiff].tolist()})
    return {label: i for i, label in enumerate(sorted(every - set(held)))}, held


def _of_abaqus(path: Path) -> Labelled:
    row, of_row, column, of_column, value = columns_of(path.read_bytes().replace(b",", b" "), "iiiif", path)
    if not len(value):
        raise StudyError(f"{path}: holds no entry; export it again")
    return _once(Labelled(np.stack([row, of_row], 1), np.stack([column, of_column], 1), value, str(path)))


def _once(found: Labelled) -> Labelled:
    """Refuse a matrix in which an entry is given twice."""
    places, counts = np.unique(np.hstack([found.row, found.column]), axis=0, return_counts=True)
    if len(places) < len(found.value):
        node, direction, other, way = places[np.argmax(counts)].tolist()
        raise StudyError(
            f"{found.source}: the entry of {node}.{direction} and {other}.{way} (node.direction) is given "
            "twice; write the file again"
        )
    return found


def _punched(path: Path, kind: str, name: str | None) -> Labelled:
    lines = path.read_bytes().decode("latin-1").splitlines()
    wanted = _named(lines, kind, name, path)
    entries: list[tuple[int, int, int, int, float]] = []
    headed = {line[8:16].strip() for line in lines if line.startswith("DMIG ")}
    of, cut_off = "", ""  # the matrix in whose columns the line is, and that whose columns another card ended
    at: tuple[int, int] | None = None
    for number, line in enumerate(lines, start=1):
        where = f"{path}, line {number}"
        if line.startswith("DMIG"):
            of = _matrix_of(line, headed - {cut_off}, where)
            at = _column(line, where) if of == wanted else None
        elif line.startswith("*") and of == wanted:
            if at is None:
                raise StudyError(
                    f"{where}: an entry of {of} without a column before it; punch the file again"
                )
            entries.append((*at, *_entry(line, where)))
        elif line[:1] not in ("$", "*"):
            of, cut_off = "", of or cut_off
    if not entries:
        raise StudyError(f"{path}: {wanted} has no entries in large fields of 16 columns; punch it again")
    table = np.array([entry[:4] for entry in entries], dtype=np.int64)
    return _once(Labelled(table[:, 2:], table[:, :2], np.array([entry[4] for entry in entries]), str(path)))


def _matrix_of(line: str, open_to: Collection[str], where: str) -> str:
    """Return the name of the matrix of a header or a column.

    Raises
    ------
    StudyError
        If it is a header without a name or without the zero behind it, a column of a matrix without a header, or a
        column of one that another card has ended: entries would be missing.
    """
    if not line.startswith("DMIG*"):
        name = line[8:16].strip()
        if not name or line[16:24].strip() != "0":
            raise StudyError(
                f"{where}: neither the header of a matrix (DMIG, name, 0 in fields of 8 columns) nor a column (DMIG*); "
                "punch the file again"
            )
        return name
    name = line[8:24].strip()
    if name not in open_to:
        raise StudyError(
            f"{where}: a column of {name or 'no matrix'} has no header, or is apart from the columns before it; punch "
            "the file again"
        )
    return name


def _named(lines: Sequence[str], kind: str, name: str | None, path: Path) -> str:
    """Return the name of the stiffness or mass among the headers of a punched file.

    A rectangular matrix beside it (MUG1T, of displacements to element forces) is neither.
    """
    forms = {line[8:16].strip(): line[24:32].strip() for line in lines if line.startswith("DMIG ")}
    return chosen({of: form in (SYMMETRIC, SQUARE) for of, form in forms.items()}, kind, name, str(path))


def _column(line: str, where: str) -> tuple[int, int] | None:
    """Return node and direction of a column; None of the header, whose form and type are checked."""
    if line.startswith("DMIG*"):
        node, direction = _whole(_fields(line, where)[1:3], where)
        return node, direction
    form, kind = line[24:32].strip(), line[32:40].strip()
    if form not in (SYMMETRIC, SQUARE) or kind not in REAL:
        raise StudyError(
            f"{where}: a matrix of form {form or '?'} and type {kind or '?'}; stiffness and mass are square (1) or "
            "symmetric (6), and real (1 or 2)"
        )
    return None


def _entry(line: str, where: str) -> tuple[int, int, float]:
    fields = _fields(line, where)
    node, direction = _whole(fields[:2], where)
    word = re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", fields[2].upper().replace("D", "E"))
    if not NUMBER.fullmatch(word) or not np.isfinite(float(word)):
        raise StudyError(f"{where}: {fields[2]!r} is not a number; punch the file again")
    return node, direction, float(word)


def _fields(line: str, where: str) -> list[str]:
    """Return the first three large fields of a line; a real matrix has nothing in the fourth."""
    *fields, rest = [line[8 + FIELD * i : 8 + FIELD * (i + 1)].strip() for i in range(4)]
    if rest or line[CARD:].strip():
        raise StudyError(f"{where}: more than three fields of {FIELD} columns; punch the file again")
    return fields


def _whole(words: Sequence[str], where: str) -> list[int]:
    if not all(word.isascii() and word.isdigit() and len(word) < 19 for word in words):
        raise StudyError(
            f"{where}: node and direction are {words}; fields are 16 columns wide, punch it again"
        )
    return [int(word) for word in words]
