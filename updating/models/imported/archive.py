"""numpy's files: what ``scipy.sparse.save_npz`` writes, or one plain two-dimensional array."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
from scipy import sparse

from acquisition.archives import MAGIC, array_of, members
from acquisition.arrays import AnyArray
from acquisition.errors import StudyError, in_one_line
from updating.models.fields import Sparse
from updating.models.imported.numerals import check_order

Arrays = Mapping[str, AnyArray]


def read_archive(path: Path) -> Sparse:
    """Read a sparse matrix, or the only two-dimensional array of an archive or of an ``.npy`` file.

    Raises
    ------
    StudyError
        If the file is no archive, holds none or several matrices, pointers that point nowhere, or not real numbers.
    """
    try:
        raw = path.read_bytes()
        if raw.startswith(MAGIC):
            return _plain({path.stem: array_of(raw)}, path)
        arrays = {name: array_of(content) for name, content in members(path).items()}
        return _sparse(arrays, path) if "format" in arrays else _plain(arrays, path)
    except (ValueError, KeyError, OSError) as error:
        reason = in_one_line(error)
        raise StudyError(
            f"{path}: not an .npz archive of one matrix ({reason}); use scipy.sparse.save_npz"
        ) from error


def _real(values: AnyArray, path: Path) -> AnyArray:
    """Return entries in double precision."""
    if values.dtype.kind not in "fiu":
        raise StudyError(f"{path}: holds {values.dtype} values; stiffness and mass are real")
    if not np.isfinite(values).all():
        raise StudyError(f"{path}: an entry is not finite; write it again")
    return np.asarray(values, dtype=np.float64)


def _plain(arrays: Arrays, path: Path) -> Sparse:
    if {"data", "shape"} <= set(arrays):
        raise ValueError("a sparse matrix without its format")
    flat = [a for a in arrays.values() if a.ndim == 2]
    if len(flat) != 1:
        names = ", ".join(sorted(arrays)) or "nothing"
        raise StudyError(f"{path}: holds {len(flat)} matrices ({names}); put one into each file")
    return Sparse(sparse.coo_array(_real(flat[0], path)).tocsr())


def _sparse(arrays: Arrays, path: Path) -> Sparse:
    """Return what ``save_npz`` wrote, every index checked before it is followed."""
    word = arrays["format"].item() if arrays["format"].size == 1 else ""
    name = word.decode("latin-1") if isinstance(word, bytes) else str(word)
    if name not in _BUILDERS:
        raise ValueError(f"format {name[:20]!r}")
    shape = [int(n) for n in _whole(arrays["shape"], 2).tolist()]
    data = _real(arrays["data"], path)
    if min(shape) < 1:
        raise ValueError(f"a matrix of {shape[0]} x {shape[1]}")
    check_order(max(shape), data.size, path)
    return Sparse(_BUILDERS[name](arrays, data, (shape[0], shape[1])).tocsr())


def _whole(values: AnyArray, count: int) -> AnyArray:
    """Return so many whole numbers in a row."""
    if values.dtype.kind not in "iu" or values.shape != (count,):
        raise ValueError(f"{values.shape} {values.dtype} where {count} whole numbers should be")
    return values.astype(np.int64)


def _index(values: AnyArray, count: int, limit: int) -> AnyArray:
    """Return indices that lie from 0 to below a limit."""
    found = _whole(values, count)
    if count and not 0 <= found.min() <= found.max() < limit:
        raise ValueError(f"an index beyond {limit} rows or columns")
    return found


def _pointers(values: AnyArray, rows: int, entries: int) -> AnyArray:
    """Return pointers that rise from 0 to the number of entries."""
    found = _whole(values, rows + 1)
    if found[0] != 0 or found[-1] != entries or (np.diff(found) < 0).any():
        raise ValueError(f"pointers that do not rise from 0 to {entries}")
    return found


def compressed(arrays: Arrays, data: AnyArray, shape: tuple[int, int], *, by_row: bool) -> sparse.coo_array:
    """Return a matrix of its entries, ``indices`` and ``indptr`` by rows or columns, which are checked before.

    Raises
    ------
    ValueError
        If pointers or indices lead nowhere.
    """
    entries, (lines, limit) = len(data), shape if by_row else shape[::-1]
    if data.ndim != 1:
        raise ValueError(f"entries of shape {data.shape}")
    along = np.repeat(np.arange(lines), np.diff(_pointers(arrays["indptr"], lines, entries)))
    across = _index(arrays["indices"], entries, limit)
    return sparse.coo_array((data, (along, across) if by_row else (across, along)), shape)


def _blocks(arrays: Arrays, data: AnyArray, shape: tuple[int, int]) -> sparse.coo_array:
    if data.ndim != 3 or 0 in data.shape or shape[0] % data.shape[1] or shape[1] % data.shape[2]:
        raise ValueError(f"blocks of shape {data.shape} in {shape[0]} x {shape[1]}")
    count, height, width = data.shape
    along = np.repeat(
        np.arange(shape[0] // height), np.diff(_pointers(arrays["indptr"], shape[0] // height, count))
    )
    across = _index(arrays["indices"], count, shape[1] // width)
    rows = (
        (along * height)[:, None, None] + np.arange(height)[:, None] + np.zeros((1, 1, width), dtype=np.int64)
    )
    columns = (across * width)[:, None, None] + np.arange(width) + np.zeros((1, height, 1), dtype=np.int64)
    return sparse.coo_array((data.ravel(), (rows.ravel(), columns.ravel())), shape)


def _triplets(arrays: Arrays, data: AnyArray, shape: tuple[int, int]) -> sparse.coo_array:
    if data.ndim != 1:
        raise ValueError(f"entries of shape {data.shape}")
    row, column = (_index(arrays[k], len(data), n) for k, n in zip(("row", "col"), shape, strict=True))
    return sparse.coo_array((data, (row, column)), shape)


def _diagonals(arrays: Arrays, data: AnyArray, shape: tuple[int, int]) -> sparse.dia_array:
    if data.ndim != 2 or data.shape[1] > shape[1]:
        raise ValueError(f"diagonals of shape {data.shape} in {shape[0]} x {shape[1]}")
    offsets = _whole(arrays["offsets"], len(data))
    if len(np.unique(offsets)) < len(offsets) or (offsets <= -shape[0]).any() or (offsets >= shape[1]).any():
        raise ValueError("a diagonal that is given twice or outside")
    return sparse.dia_array((data, offsets), shape)


_BUILDERS: Mapping[
    str, Callable[[Arrays, AnyArray, tuple[int, int]], sparse.coo_array | sparse.dia_array]
] = MappingProxyType(
    {
        "csr": lambda arrays, data, shape: compressed(arrays, data, shape, by_row=True),
        "csc": lambda arrays, data, shape: compressed(arrays, data, shape, by_row=False),
        "bsr": _blocks,
        "coo": _triplets,
        "dia": _diagonals,
    }
)
