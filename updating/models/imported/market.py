"""MatrixMarket: ``.mtx``, ``.mtx.gz``."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import AnyArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.numerals import check_order, columns_of
from updating.models.imported.packed import unpacked

_HEAD = re.compile(rb"%%MatrixMarket\s+matrix\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def read_market(path: Path) -> Sparse:
    """Read a real matrix of a MatrixMarket file, symmetric or general, coordinate or array.

    The format is that of Boisvert, Pozo and Remington (1996), NISTIR 5935.

    Raises
    ------
    StudyError
        If the file is no real MatrixMarket matrix, or not whole.
    """
    text = unpacked(path) if path.suffix.lower() == ".gz" else path.read_bytes()
    form, symmetry = _kind(bytes(text[: max(text.find(b"\n", 0, 1000), 0)].strip()), path)
    size, body, first = _sized(text, path)
    whole = (3, "three") if form == "coordinate" else (2, "two")
    if len(size) != whole[0] or not all(word.isdigit() and len(word) < 19 for word in size):
        raise StudyError(
            f"{path}, line {first - 1}: the size is not given in {whole[1]} whole numbers; write it again"
        )
    numbers = [int(word) for word in size]
    if symmetry == "symmetric" and numbers[0] != numbers[1]:
        raise StudyError(f"{path}: symmetric, but {numbers[0]} x {numbers[1]}; write it again")
    if form == "array":
        return _dense(columns_of(body, "f", path, first=first)[0], numbers[0], numbers[1], symmetry, path)
    row, column, value = columns_of(body, "iif", path, first=first)
    _check_count(len(value), numbers[2], path)
    check_order(max(numbers[:2]), len(value), path)
    for index, limit, name in ((row, numbers[0], "row"), (column, numbers[1], "column")):
        if wrong := index[(index < 1) | (index > limit)][:1].tolist():
            raise StudyError(
                f"{path}: {name} {wrong[0]} in a matrix of {numbers[0]} x {numbers[1]}; write it again"
            )
    matrix = sparse.coo_array((value, (row - 1, column - 1)), (numbers[0], numbers[1]))
    return _completed(matrix) if symmetry == "symmetric" else Sparse(matrix.tocsr())


def _kind(head: bytes, path: Path) -> tuple[str, str]:
    """Return format and symmetry that the first line states."""
    found = _HEAD.fullmatch(head)
    if found is None:
        raise StudyError(f"{path}: not a MatrixMarket file: its first line is not %%MatrixMarket matrix ...")
    form, field, symmetry = (word.decode("latin-1").lower() for word in found.groups())
    if field not in ("real", "integer", "double", "unsigned-integer"):
        raise StudyError(f"{path}: holds {field} values; stiffness and mass are real")
    if form not in ("coordinate", "array") or symmetry not in ("general", "symmetric"):
        raise StudyError(f"{path}: {form} {symmetry}; give coordinate or array, general or symmetric")
    return form, symmetry


def _sized(text: bytes | bytearray, path: Path) -> tuple[list[bytes], bytes, int]:
    """Return the words of the line of the size, what follows it, and the number of the line that follows."""
    start, number = 0, 0
    while start < len(text):
        stop = text.find(b"\n", start)
        stop = len(text) if stop < 0 else stop
        line = text[start:stop].strip()
        start, number = stop + 1, number + 1
        if line and not line.startswith(b"%"):
            return [bytes(word) for word in line.split()], bytes(memoryview(text)[start:]), number + 1
    raise StudyError(f"{path}: not a MatrixMarket file: no line with its size; write it again")


def _check_count(found: int, stated: int, path: Path) -> None:
    if found != stated:
        raise StudyError(f"{path}: {stated} entries announced and {found} there; the file was cut or changed")


def _dense(values: AnyArray, rows: int, columns: int, symmetry: str, path: Path) -> Sparse:
    """Return the matrix of all entries, column by column; of a symmetric one those from the diagonal on."""
    if symmetry == "general":
        _check_count(len(values), rows * columns, path)
        return Sparse(sparse.coo_array(values.reshape(columns, rows).T).tocsr())
    _check_count(len(values), rows * (rows + 1) // 2, path)
    lower = np.zeros((rows, rows))
    lower.T[np.triu_indices(rows)] = values
    return Sparse(sparse.coo_array(lower + np.tril(lower, -1).T).tocsr())


def _completed(matrix: sparse.coo_array) -> Sparse:
    """Return a symmetric matrix of which one triangle is stored; one that is stored whole as it is."""
    above, off = matrix.row < matrix.col, matrix.row != matrix.col
    place = matrix.row.astype(np.int64) * matrix.shape[0] + matrix.col
    mirrored = matrix.col.astype(np.int64) * matrix.shape[0] + matrix.row
    stored = matrix.tocsr()
    if np.isin(place[above], mirrored[off & ~above]).any():
        return Sparse(stored)
    return Sparse(stored + stored.T - sparse.diags_array(stored.diagonal()))
