"""What another program computed from a text, kept by the text's content in a folder of the user's."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

VARIABLE = "MODALKIT_CACHE"
"""Names the folder; empty, nothing is kept."""

MOST = 8e9
"""The largest size of the folder [bytes]: what was used longest ago goes first. The matrices of a deck of 100 000
degrees of freedom take some 0.3 GB, one of each region as much at most; half of it would not hold one such study."""

Arrays = Mapping[str, "np.ndarray[Any, Any]"]


def cache_folder() -> Path | None:
    """Return the folder; None where nothing is to be kept."""
    stated = os.environ.get(VARIABLE)
    if stated is not None:
        return Path(stated) if stated else None
    above = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return Path(above) / "modalkit" if above else Path.home() / ".cache" / "modalkit"


def kept(key: str, make: Callable[[], Arrays]) -> Arrays:
    """Return the arrays that are kept under a key, made and kept now if there are none.

    A folder that cannot be written, or a file that cannot be read, costs time and nothing else.
    """
    folder = cache_folder()
    if folder is None:
        return make()
    path = folder / f"{key}.npz"
    found = _read(path)
    if found is not None:
        return found
    arrays = make()
    _write(path, arrays)
    return arrays


def _read(path: Path) -> Arrays | None:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        os.utime(path)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile):
        return None
    return arrays


def _write(path: Path, arrays: Arrays) -> None:
    """Write a file whole or not at all, and make room for it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".part", delete=False) as aside:
            try:
                # without allow_pickle: numpy 2.0 keeps that as one more array
                np.savez(aside, **arrays)  # type: ignore[arg-type]
                aside.close()  # before it is renamed: on some systems an open file cannot be
                Path(aside.name).replace(path)
            finally:
                aside.close()
                Path(aside.name).unlink(missing_ok=True)
        _make_room(path.parent)
    except OSError:
        return


def _make_room(folder: Path) -> None:
    files = sorted(((f.stat().st_mtime, f.stat().st_size, f) for f in folder.glob("*.npz")), reverse=True)
    total = 0.0
    for _, size, file in files:
        total += size
        if total > MOST:
            file.unlink(missing_ok=True)
