"""Files of recorders and of numerical programs as named channels; each library is loaded when a file needs it."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from acquisition.arrays import AnyArray
from acquisition.errors import InputError
from acquisition.recorders.channels import SAME_RATE, Channels
from acquisition.recorders.recorded import Recorded

RECORDERS = MappingProxyType({".tdms": "tdms", ".wav": "wav"})
"""Endings of files of numbered channels, and the modules that read them."""

ARRAYS = MappingProxyType({".h5": "hdf5", ".hdf5": "hdf5", ".npz": "npz", ".mat": "matlab.named"})
"""Endings of files of named arrays, and the modules that read them."""

ENDINGS = frozenset({*RECORDERS, *ARRAYS})

__all__ = ["ARRAYS", "ENDINGS", "RECORDERS", "SAME_RATE", "Channels", "Recorded", "is_recorded", "recorded"]


def is_recorded(path: Path) -> bool:
    """Return whether a file is one of a recorder or of named arrays, by its ending."""
    return path.suffix.lower() in ENDINGS


def recorded(path: Path, names: Sequence[str | int] = (), *, rate: str | None = None) -> Sequence[Channels]:
    """Return the records of a file, each with its channels.

    Parameters
    ----------
    path : Path
        The file; `is_recorded` holds for it.
    names : sequence of str or int
        Channels that are asked for; a file of named arrays gives these alone, and numbers none.
    rate : str, optional
        Which of its named arrays is the sampling rate [Hz].

    Raises
    ------
    InputError
        If the file cannot be read, is damaged, or a library that reads it is not installed.
    """
    ending = path.suffix.lower()
    _check_readable(path)
    if ending in ARRAYS:
        from acquisition.recorders.arrays import records_of

        words = [name for name in names if isinstance(name, str)]
        if not words or len(words) < len(names):
            raise InputError(
                f"{path}: its arrays are named, not numbered; give name = ... in each [[column]]"
            )
        return records_of(path, _module(ARRAYS[ending]).named_arrays, words, rate)
    if rate is not None:
        raise InputError(
            f"{path}: rate = {rate!r} names an array, but only {', '.join(ARRAYS)} have named arrays; leave rate out "
            "if the file states it, or give it in Hz"
        )
    found: list[Recorded] = _module(RECORDERS[ending]).records(path)
    return found


def listed(path: Path) -> Sequence[Channels]:
    """Return the records of a file with all channels that it holds, for a layout to be written.

    Raises
    ------
    InputError
        As of `recorded`.
    """
    ending = path.suffix.lower()
    if ending in RECORDERS:
        return recorded(path)
    from acquisition.recorders.arrays import all_records

    _check_readable(path)
    module = _module(ARRAYS[ending])
    return all_records(path, module.named_arrays, module.names_of(path))


def all_arrays(path: Path) -> Mapping[str, AnyArray]:
    """Return all arrays of numbers of a file of named arrays.

    Raises
    ------
    InputError
        As of `recorded`.
    """
    _check_readable(path)
    module = _module(ARRAYS[path.suffix.lower()])
    values: Mapping[str, AnyArray] = module.named_arrays(path, module.names_of(path)).values
    return values


def _module(name: str) -> Any:
    return importlib.import_module(f"acquisition.recorders.{name}")


def _check_readable(path: Path) -> None:
    try:
        with path.open("rb") as file:
            file.read(1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
