"""Arrays that numpy saved by name, ``np.savez``; no object in them is made."""

from __future__ import annotations

import math
import re
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError
from acquisition.recorders.arrays import Named
from acquisition.recorders.channels import LISTED

_HEADER = re.compile(
    rb"\s*\{\s*'descr':\s*'([<>|=]?)([fiuc])(\d{1,2})',\s*'fortran_order':\s*(True|False),"
    rb"\s*'shape':\s*\(((?:\d{1,18},\s*)*(?:\d{1,18}\s*)?)\),?\s*\}\s*"
)
_RATIO, _FREE = 30, 10_000_000
"""Bytes that one packed byte may become, and that any file may: measured numbers shrink to half. Twice as much would
take twice the memory [-, bytes]."""


def named_arrays(path: Path, names: Sequence[str]) -> Named:
    """Return arrays of an archive by name.

    Raises
    ------
    InputError
        If the archive is damaged, or an array is not in it or holds no numbers.
    """
    members = _members(path)
    missing = [name for name in names if name not in members]
    if missing:
        known = ", ".join(map(repr, list(members)[:LISTED])) + (", ..." if len(members) > LISTED else "")
        raise InputError(f"{path}: no array {missing[0]!r} in it; there are {known or 'none'}")
    arrays = {name: _array(members[name]) for name in names}
    odd = [name for name, array in arrays.items() if array is None]
    if odd:
        raise InputError(f"{path}: {odd[0]!r} is damaged or holds no numbers; save it again as numbers")
    return Named({name: array for name, array in arrays.items() if array is not None})


def names_of(path: Path) -> list[str]:
    """Return the names of all arrays of numbers in an archive.

    Raises
    ------
    InputError
        If the archive is damaged.
    """
    return [name for name, raw in _members(path).items() if _array(raw) is not None]


def _members(path: Path) -> Mapping[str, bytes]:
    """Return what an archive holds by name, unpacked within what its size allows."""
    packed = path.stat().st_size
    try:
        with zipfile.ZipFile(path) as archive:
            infos = archive.infolist()
            large = sum(info.file_size for info in infos) > _RATIO * packed + _FREE
            if large or any(info.compress_size > packed for info in infos):
                raise ValueError("its arrays are larger than a file of this size can hold")
            if len({info.filename for info in infos}) < len(infos):
                raise ValueError("two arrays of one name")
            return {info.filename.removesuffix(".npy"): archive.read(info) for info in infos}
    # zipfile raises NotImplementedError for ways of packing that it does not know, RuntimeError for a password
    except (ValueError, KeyError, OSError, EOFError, NotImplementedError, RuntimeError, zlib.error,
            zipfile.BadZipFile) as error:  # fmt: skip
        statement = " ".join(str(error).split())[:200]
        raise InputError(
            f"{path}: not a whole .npz archive ({statement}); save it again by np.savez"
        ) from error


def _array(raw: bytes) -> AnyArray | None:
    """Return the array of a ``.npy`` whose header states what follows it, to the byte; None for any other content."""
    start = 12 if raw[6:7] == b"\x02" else 10
    body = start + int.from_bytes(raw[8:start], "little")
    found = _HEADER.fullmatch(raw[start:body])
    if raw[:6] != b"\x93NUMPY" or raw[6:7] not in (b"\x01", b"\x02") or found is None:
        return None
    order, kind, size, fortran, numbers = (word.decode("ascii") for word in found.groups())
    try:
        dtype = np.dtype(f"{order}{kind}{size}")
    except TypeError:
        return None
    shape = tuple(int(n) for n in re.findall(r"\d+", numbers))
    if math.prod(shape) * dtype.itemsize != len(raw) - body:
        return None
    return np.frombuffer(raw, dtype=dtype, offset=body).reshape(
        shape, order="F" if fortran == "True" else "C"
    )
