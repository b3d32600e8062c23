"""Libraries of the extra ``recorders``, which is not needed for universal files and text."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from acquisition.errors import InputError


def library(name: str, path: Path) -> Any:
    """Return a library that reads a file.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(
            f"{path}: {path.suffix} files are read by {name}, which is not installed; "
            "install modalkit-ema[recorders]"
        ) from error
