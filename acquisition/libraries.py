"""Libraries of the extras, which are loaded when a file needs one."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from acquisition.errors import InputError


def library(module: str, path: Path, *, extra: str, does: str = "read") -> Any:
    """Return a module of a library that reads or writes a file.

    Parameters
    ----------
    module : str
        Its full name; the first word is that of the library.
    path : Path
        The file, for messages.
    extra : str
        Which extra of modalkit-ema installs it.
    does : str
        What the library does with the file: "read" or "written".

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(
            f"{path}: {path.suffix} files are {does} by {module.partition('.')[0]}, which is not installed; "
            f"install modalkit-ema[{extra}]"
        ) from error
