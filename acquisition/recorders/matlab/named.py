"""Variables of a MATLAB file as named arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from acquisition.recorders.arrays import Named
from acquisition.recorders.matlab.file import listed, variables


def named_arrays(path: Path, names: Sequence[str]) -> Named:
    """Return variables by name; fields of structures with a dot, ``test.force``.

    Raises
    ------
    InputError
        If the file cannot be read, or a variable is not in it or holds no numbers.
    """
    return Named(variables(path, list(names)))


names_of = listed
