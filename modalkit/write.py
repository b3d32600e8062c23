"""Outputs are written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.errors import InputError


def write_text(path: Path, text: str) -> None:
    """Write a text file in one step: what stood there before stays until the new file is complete.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written.
    """
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}); name a folder that exists"
        ) from error
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        Path(name).unlink(missing_ok=True)


def check_place(path: Path | None) -> None:
    """See that a file could be written, before work begins whose result would be lost; None is no file.

    Raises
    ------
    InputError
        If its folder does not exist or cannot be written, or it is a folder itself.
    """
    if path is None:
        return
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    if not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        raise InputError(
            f"{path}: cannot be written (no such folder, or read-only); name a folder that exists"
        )


def check_json_place(path: Path | None) -> None:
    """See that a JSON file could be written, and that no other file stands there, such as the study itself.

    Raises
    ------
    InputError
        If one does, or the folder cannot be written.
    """
    check_place(path)
    if path is None or not path.is_file() or not path.stat().st_size:
        return
    try:
        json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: stands there and is no JSON; name another file for the result") from error


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file in one step; what is not finite becomes null.

    Raises
    ------
    InputError
        If it cannot be written, or another file than JSON stands there.
    """
    check_json_place(path)
    write_text(path, json.dumps(plain(content), indent=1, allow_nan=False) + "\n")


def plain(value: Any) -> Any:
    """Take numpy values, tuples and what is not finite to what JSON knows."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return [plain(v) for v in value.tolist()]
    if isinstance(value, np.bool_ | bool):
        return bool(value)
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value
