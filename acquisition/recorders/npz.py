"""Arrays that numpy saved by name, ``np.savez``; no object in them is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from acquisition.archives import array_of, members
from acquisition.arrays import AnyArray
from acquisition.errors import InputError
from acquisition.recorders.arrays import Named
from acquisition.recorders.channels import LISTED


def named_arrays(path: Path, names: Sequence[str]) -> Named:
    """Return arrays of an archive by name.

    Raises
    ------
    InputError
        If the archive is damaged, or an array is not in it or holds no numbers.
    """
    held = _held(path)
    missing = [name for name in names if name not in held]
    if missing:
        known = ", ".join(map(repr, list(held)[:LISTED])) + (", ..." if len(held) > LISTED else "")
        raise InputError(f"{path}: no array {missing[0]!r} in it; there are {known or 'none'}")
    arrays = {name: _numbers(held[name]) for name in names}
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
    return [name for name, raw in _held(path).items() if _numbers(raw) is not None]


def _held(path: Path) -> Mapping[str, bytes]:
    try:
        return members(path)
    except ValueError as error:
        raise InputError(f"{path}: not a whole .npz archive ({error}); save it again by np.savez") from error


def _numbers(raw: bytes) -> AnyArray | None:
    """Return an array of numbers; None for any other content."""
    try:
        array = array_of(raw)
    except ValueError:
        return None
    return array if array.dtype.kind in "fiuc" else None
