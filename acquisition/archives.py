"""numpy's files: what an archive holds, unpacked within what its size allows, and the arrays in it, no object made."""

from __future__ import annotations

import math
import re
import zipfile
import zlib
from pathlib import Path

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import in_one_line

RATIO = 30
"""Bytes that one packed byte may become [-]: numbers as text shrink three- to twentyfold, measured ones to half; twice
as much would fill twice the memory."""

SMALL = 10_000_000
"""Bytes that any packed file may become, however small it is [-]: less than the libraries take that read it."""

LONGEST = 64
"""Characters that a word among the arrays may have [-]; the names of formats have three."""

MAGIC = b"\x93NUMPY"
"""What an array of numpy begins with."""

_HEADER = re.compile(
    rb"\s*\{\s*'descr':\s*'([<>|=]?)([fiucbSU])(\d{1,4})',\s*'fortran_order':\s*(True|False),"
    rb"\s*'shape':\s*\(((?:\d{1,18},\s*)*(?:\d{1,18}\s*)?)\),?\s*\}\s*"
)


def allowed(packed: int) -> int:
    """Return the bytes that so many packed bytes may become."""
    return max(SMALL, RATIO * packed)


def members(path: Path) -> dict[str, bytes]:
    """Return what an archive of numpy holds, by name without ``.npy``.

    Raises
    ------
    ValueError
        If it is damaged, cannot be read, or becomes too much.
    """
    packed = path.stat().st_size
    try:
        with zipfile.ZipFile(path) as archive:
            infos = archive.infolist()
            if sum(info.file_size for info in infos) > allowed(packed):
                raise ValueError(f"{packed} bytes that decompress to more than {allowed(packed)}")
            if any(info.compress_size > packed for info in infos):  # zipfile would make room for them
                raise ValueError("an array of more bytes than the archive has")
            if len({info.filename.removesuffix(".npy") for info in infos}) < len(infos):
                raise ValueError("two arrays of one name")
            return {info.filename.removesuffix(".npy"): archive.read(info) for info in infos}
    # zipfile raises NotImplementedError for ways of packing that it does not know, RuntimeError for a password
    except (ValueError, KeyError, OSError, EOFError, NotImplementedError, RuntimeError, zlib.error,
            zipfile.BadZipFile) as error:  # fmt: skip
        raise ValueError(in_one_line(error)) from error


def array_of(raw: bytes) -> AnyArray:
    """Return the array of an ``.npy``: its header must state what follows it, to the byte.

    Raises
    ------
    ValueError
        If it does not, or the array is not of numbers or short words.
    """
    start = 12 if raw[6:7] == b"\x02" else 10
    if raw[:6] != MAGIC or raw[6:7] not in (b"\x01", b"\x02"):
        raise ValueError("no array of numpy in it")
    body = start + int.from_bytes(raw[8:start], "little")
    found = _HEADER.fullmatch(raw[start:body])
    if found is None:
        raise ValueError("the header of an array cannot be read, or it holds objects")
    order, kind, size, fortran, numbers = (word.decode("ascii") for word in found.groups())
    if kind in "SU" and int(size) > LONGEST:
        raise ValueError("a word of an array is too long")
    try:
        dtype = np.dtype(f"{order}{kind}{size}")
    except TypeError as error:
        raise ValueError(f"an array of {kind}{size}, which is not a kind of number") from error
    shape = tuple(int(n) for n in re.findall(r"\d+", numbers))
    if math.prod(shape) * dtype.itemsize != len(raw) - body:
        raise ValueError(f"an array of shape {shape} in {len(raw) - body} bytes")
    flat = np.frombuffer(raw, dtype=dtype, offset=body)
    return flat.reshape(shape, order="F" if fortran == "True" else "C")
