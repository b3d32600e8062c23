"""Harwell-Boeing: ``.hb``, ``.rsa``, ``.rua``, ``.rb``, as Nastran, Ansys and older collections write it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse

_FORMAT = re.compile(r"\(?\s*(?:-?\d*P\s*,?\s*)?(\d*)\s*[IEDFG](\d+)", re.IGNORECASE)
_TYPE = re.compile(r"R[SU]A", re.IGNORECASE)


def read_boeing(path: Path) -> Sparse:
    """Read a real assembled matrix, symmetric (one triangle) or unsymmetric.

    The format is that of Duff, Grimes and Lewis (1989), ACM Transactions on Mathematical Software 15.

    Raises
    ------
    StudyError
        If the file is none, or of a type that no stiffness matrix has.
    """
    lines = path.read_text(encoding="latin-1").splitlines()
    try:
        return _read(lines, path)
    except (ValueError, IndexError) as error:
        raise StudyError(
            f"{path}: not a Harwell-Boeing file, or cut short ({error}); write it anew or use MatrixMarket"
        ) from error


def _read(lines: list[str], path: Path) -> Sparse:
    counts = [int(lines[1][i : i + 14]) for i in range(14, 56, 14)]
    kind = lines[2][:3]
    if not _TYPE.fullmatch(kind):
        raise StudyError(f"{path}: Harwell-Boeing type {kind!r}; use RSA or RUA, real and assembled")
    rows, columns, entries = (int(lines[2][14 + i : 28 + i]) for i in (0, 14, 28))
    formats = [lines[3][:16], lines[3][16:32], lines[3][32:52]]
    right_sides = int(lines[1][56:70].strip() or 0) if len(lines[1]) > 56 else 0
    at = 5 if right_sides else 4
    blocks = []
    for lines_of_block, layout, count in zip(counts, formats, (columns + 1, entries, entries), strict=True):
        blocks.append(_numbers(lines[at : at + lines_of_block], layout, count))
        at += lines_of_block
    pointer, index = (block.astype(np.int64) - 1 for block in blocks[:2])
    matrix = sparse.csc_array((blocks[2], index, pointer), (rows, columns))
    if kind[1] in "Ss":
        matrix = matrix + sparse.tril(matrix, -1).T + sparse.triu(matrix, 1).T
    return Sparse(matrix.tocsr())


def _numbers(lines: list[str], layout: str, count: int) -> FloatArray:
    """Cut lines in fields of fixed width, as Fortran does: numbers may touch. Else split them at blanks."""
    found = _FORMAT.search(layout)
    if found is None:
        raise ValueError(f"format {layout.strip()!r}")
    each, width = int(found.group(1) or 1), int(found.group(2))
    fields = [line[i * width : (i + 1) * width] for line in lines for i in range(each)]
    try:
        values = _floats(f for f in fields if f.strip())
    except ValueError:
        values = _floats(word for line in lines for word in line.split())
    if len(values) < count:
        raise ValueError(f"{len(values)} numbers where {count} should be")
    return np.asarray(values[:count])


def _floats(words: Iterable[str]) -> FloatArray:
    return np.array([word.replace("D", "E").replace("d", "e") for word in words], dtype=float)
