"""MATLAB's files of versions 5 to 7: one matrix, sparse or full, each.

The format is that of MATLAB's *MAT-File Format*: elements of a type, a size and a body, packed ones with zlib. Read
here, as the reader of scipy ends the whole process on some damaged files.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.archives import allowed
from acquisition.arrays import AnyArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.archive import compressed
from updating.models.imported.numerals import check_order
from updating.models.imported.packed import too_much

_HEAD, _TAG, _FLAGS = 128, 8, 8
"""Bytes of the file's head, of the tag before an element, and of the flags of an array [-]."""
_MATRIX, _PACKED = 14, 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""Types of elements that hold numbers."""
_SPARSE, _FULL = 5, range(6, 16)
"""Classes of arrays: sparse ones, and full ones of numbers; words, cells and structures are passed over."""
_COMPLEX = 0x0800
_AGAIN = "save it anew with save(file, 'K', '-v7')"


@dataclass(frozen=True)
class _Element:
    kind: int
    body: bytes


@dataclass(frozen=True, eq=False)
class _Variable:
    name: str
    matrix: Sparse


def read_matlab(path: Path) -> Sparse:
    """Read the only matrix of a ``.mat``; numbers, words and vectors beside it are passed over.

    Raises
    ------
    StudyError
        If the file is of another version or damaged, holds none or several matrices, or not real numbers.
    """
    raw = path.read_bytes()
    if raw[:4] == b"\x89HDF" or raw[:10] == b"MATLAB 7.3":
        raise StudyError(f"{path}: a .mat of version 7.3; {_AGAIN}")
    order = {b"IM": "<", b"MI": ">"}.get(raw[126:128])
    if order is None:
        raise StudyError(f"{path}: not a .mat of version 5 to 7; {_AGAIN}")
    try:
        arrays = (_unpacked(element, order, path) for element in _elements(raw[_HEAD:], order))
        found = [v for a in arrays for v in [_variable(_array(a), order, path)] if v]
    except (ValueError, KeyError, IndexError, struct.error, zlib.error) as error:
        raise StudyError(f"{path}: not a whole .mat ({' '.join(str(error).split())}); {_AGAIN}") from error
    if len(found) != 1:
        names = ", ".join(sorted(variable.name for variable in found)) or "none"
        raise StudyError(f"{path}: holds {len(found)} matrices ({names}); put one into each file")
    return found[0].matrix


def _elements(raw: bytes, order: str) -> Iterator[_Element]:
    """Give the elements that follow each other in some bytes."""
    at = 0
    while at < len(raw):
        kind, size = struct.unpack_from(f"{order}II", raw, at)
        if small := kind >> 16:  # of four bytes at most, which stand in the tag
            kind, size, body = kind & 0xFFFF, _TAG, raw[at + 4 : at + 4 + small]
        else:
            at += _TAG
            body = raw[at : at + size]
            if len(body) < size:
                raise ValueError(f"an element of {size} bytes where {len(body)} are left")
            size += 0 if kind == _PACKED else -size % 8
        at += size
        yield _Element(kind, body)


def _unpacked(element: _Element, order: str, path: Path) -> _Element:
    """Return an element, unpacked within what the size of the file allows."""
    if element.kind != _PACKED:
        return element
    packed, unpacking = path.stat().st_size, zlib.decompressobj()
    plain = unpacking.decompress(element.body, allowed(packed) + 1)
    if len(plain) > allowed(packed):
        raise too_much(path, packed)
    if not unpacking.eof:
        raise ValueError("a packed element that is cut short")
    found = list(_elements(plain, order))
    if len(found) != 1:
        raise ValueError(f"{len(found)} elements packed as one")
    return found[0]


def _array(element: _Element) -> bytes:
    """Return the body of an element that is an array, as all variables are."""
    if element.kind != _MATRIX:
        raise ValueError(f"an element of type {element.kind} among its variables")
    return element.body


def _variable(body: bytes, order: str, path: Path) -> _Variable | None:
    """Return a variable that is a matrix of numbers, None for any other."""
    flags, dimensions, name, *parts = _elements(body, order)
    if len(flags.body) != _FLAGS:
        raise ValueError("an array without flags")
    (word,) = struct.unpack_from(f"{order}I", flags.body)
    shape = tuple(int(n) for n in _numbers(dimensions, order))
    kind, called = word & 0xFF, name.body.decode("latin-1")
    if len(shape) != 2 or min(shape) < 2 or (kind != _SPARSE and kind not in _FULL):
        return None
    if word & _COMPLEX:
        raise StudyError(f"{path}: {called} holds complex values; stiffness and mass are real")
    rows, columns = shape
    if kind == _SPARSE:
        indices, pointers = (_numbers(part, order) for part in parts[:2])
        # room for more entries than there are may follow them
        entries = _real(_numbers(parts[2], order)[: int(pointers[-1])], path)
        check_order(max(shape), len(entries), path)
        arrays = {"indices": indices[: len(entries)], "indptr": pointers}
        found = compressed(arrays, entries, (rows, columns), by_row=False)
        if _twice(found):
            raise ValueError("an entry that stands twice")
        return _Variable(called, Sparse(found.tocsr()))
    values = _real(_numbers(parts[0], order), path)
    if len(values) != prod(shape):
        raise ValueError(f"{len(values)} values in a matrix of {rows} x {columns}")
    return _Variable(called, Sparse(sparse.coo_array(values.reshape(shape, order="F")).tocsr()))


def _twice(matrix: sparse.coo_array) -> bool:
    """Tell whether an entry stands twice, as none does in a file of MATLAB: a sum would be a wrong number."""
    place = np.asarray(matrix.row, dtype=np.int64) * matrix.shape[1] + matrix.col
    return len(np.unique(place)) < len(place)


def _numbers(element: _Element, order: str) -> AnyArray:
    return np.frombuffer(element.body, dtype=np.dtype(order + _NUMBERS[element.kind]))


def _real(values: AnyArray, path: Path) -> AnyArray:
    """Return entries in double precision."""
    found = values.astype(np.float64)
    if not np.isfinite(found).all():
        raise StudyError(f"{path}: an entry is not finite; write it anew")
    return found
