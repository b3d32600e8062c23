"""Named data sets of HDF5 files."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError, in_one_line
from acquisition.libraries import library
from acquisition.recorders.arrays import Named
from acquisition.recorders.channels import LISTED

_UNITS = ("unit", "units", "Unit", "Units")
"""Attributes of a data set that state its unit."""

_LARGEST_RATIO, _FREE = 100, 10_000_000
"""A data set may take this many times the file's size, and 10 MB in any case: packed measurements take 1 to 10 times.
Doubled, a damaged file takes twice the memory [-, bytes]."""


_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def _check_end(path: Path) -> None:
    """Refuse a file that goes on behind the end that it states: what stands in it has moved.

    The library sees what is cut off alone. ("HDF5 File Format Specification", II.A, superblock.)
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        for start in (0, *(512 << k for k in range(size.bit_length()))):
            file.seek(start)
            head = file.read(64)
            if head.startswith(_SIGNATURE) and len(head) == 64:
                break
        else:
            raise ValueError("its signature is missing")
    version = head[8]
    width, addresses = (head[9], 12) if version >= 2 else (head[13], 28 if version else 24)
    at = addresses + 2 * width
    stated = int.from_bytes(head[at : at + width], "little")
    if stated != size:
        raise ValueError(f"its header states {stated} bytes, the file has {size}")


def named_arrays(path: Path, names: Sequence[str]) -> Named:
    """Return data sets by their path in the file, ``hits/force``.

    Raises
    ------
    InputError
        If the file is damaged, a data set is not in it, or h5py is not installed.
    """
    h5py = library("h5py", path, extra="recorders")
    values: dict[str, AnyArray] = {}
    units: dict[str, str] = {}
    try:
        _check_end(path)
        with h5py.File(path, "r") as file:
            for name in names:
                found = file.get(name)
                if not isinstance(found, h5py.Dataset):
                    raise InputError(
                        f"{path}: no data set {name!r} in it; there are {_listed(_names(file, h5py))}"
                    )
                _check_size(found, name, path)
                _check_bits(found, name, path, h5py)
                _check_chunks(found, name, path)
                values[name] = np.asarray(found[()])
                units[name] = next((unit for key in _UNITS if (unit := _text(found.attrs.get(key)))), "")
    except InputError:
        raise
    except Exception as error:  # the library raises what a damaged file happens to lead to
        raise _damaged(path, error) from error
    return Named(values, units)


def names_of(path: Path) -> list[str]:
    """Return the paths of all data sets of numbers in a file.

    Raises
    ------
    InputError
        If the file is damaged, or h5py is not installed.
    """
    h5py = library("h5py", path, extra="recorders")
    try:
        _check_end(path)
        with h5py.File(path, "r") as file:
            return [name for name in _names(file, h5py) if file[name].dtype.kind in "fiuc"]
    except Exception as error:  # the library raises what a damaged file happens to lead to
        raise _damaged(path, error) from error


def _names(file: Any, h5py: Any) -> list[str]:
    found: list[str] = []
    file.visititems(lambda name, one: found.append(name) if isinstance(one, h5py.Dataset) else None)
    return found


def _check_size(found: Any, name: str, path: Path) -> None:
    size = found.size * found.dtype.itemsize if found.size else 0
    if size > _LARGEST_RATIO * path.stat().st_size + _FREE:
        raise InputError(
            f"{path}: {name!r} takes {size} bytes, over {_LARGEST_RATIO} times the file's size, which measured data "
            "never do; the file is damaged, or contains no measurement"
        )


def _check_bits(found: Any, name: str, path: Path, h5py: Any) -> None:
    """Refuse numbers whose sign, exponent and digits stand elsewhere than in those of any computer.

    A file states where they stand, without a checksum; the library takes any places. ("HDF5 File Format
    Specification", IV.A.2.d, datatype message.)
    """
    if found.dtype.kind not in "fiu" or h5py.h5t.py_create(found.dtype, logical=True) == found.id.get_type():
        return
    raise InputError(
        f"{path}: {name!r} has an unknown format of {8 * found.dtype.itemsize}-bit numbers; the file is "
        "damaged, or has to be exported again with standard numbers"
    )


def _check_chunks(found: Any, name: str, path: Path) -> None:
    """Refuse numbers in chunks of which one is missing, where the library would put zeros.

    The places of chunks stand in an index without a checksum. ("HDF5 File Format Specification", III.A.1.)
    """
    if found.chunks is None or not found.size:
        return
    grid = product(*(range(0, n, step) for n, step in zip(found.shape, found.chunks, strict=True)))
    stored: set[tuple[int, ...]] = set()
    found.id.chunk_iter(lambda chunk: stored.add(chunk.chunk_offset))
    if missing := [at for at in grid if at not in stored]:
        raise InputError(
            f"{path}: {name!r} lacks the numbers from index {', '.join(map(str, missing[0]))} on, "
            f"one of its chunks of {found.chunks}; the file is damaged, or was not written to its end: export it again"
        )


def _text(value: Any) -> str:
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else str(value or "")


def _listed(names: Sequence[str]) -> str:
    return (", ".join(map(repr, names[:LISTED])) or "none") + (", ..." if len(names) > LISTED else "")


def _damaged(path: Path, error: Exception) -> InputError:
    reason = in_one_line(error)
    return InputError(f"{path}: not a whole HDF5 file ({reason}); export it again")
