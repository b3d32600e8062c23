"""Find the studies of a folder."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from acquisition.errors import InputError, ModalkitError
from modalkit.study.read import read_study


@dataclass(frozen=True)
class Found:
    """A study of a folder.

    Parameters
    ----------
    name : str
        Its path in the folder, with ``/``.
    path : Path
        The study file.
    digest : str
        SHA-256 of the study file and of every file it names, hexadecimal: what the result depends on.
    inputs : tuple of Path
        These files; the study file alone where it cannot be read.
    """

    name: str
    path: Path
    digest: str
    inputs: tuple[Path, ...] = ()


def find_studies(folder: Path | str) -> tuple[Found, ...]:
    """Return the studies of a folder and the folders in it, in the order of their paths.

    Parameters
    ----------
    folder : path
        Where to look. A TOML file with a ``[test]`` is a study, and so is one that cannot be read, for it may be
        one that is broken; hidden folders are passed over.

    Raises
    ------
    InputError
        If there is no such folder, or no study in it.
    """
    folder = Path(folder)
    if folder.is_file():
        raise InputError(f"{folder}: is a file; name the folder of the studies")
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; name the one of the studies")
    paths = [p for p in sorted(folder.rglob("*.toml")) if _is_open(p.relative_to(folder)) and _is_study(p)]
    if not paths:
        raise InputError(f"{folder}: no study in it; a study is a .toml file with a [test]")
    return tuple(_found(path, path.relative_to(folder).as_posix()) for path in paths)


def _is_open(path: Path) -> bool:
    return not any(part.startswith(".") for part in path.parts)


def _is_study(path: Path) -> bool:
    try:
        return "test" in tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return True


def _found(path: Path, name: str) -> Found:
    try:
        inputs = read_study(path).inputs()
    except ModalkitError:
        inputs = (path,)
    return Found(name, path, _digest(inputs), inputs)


def _digest(inputs: Sequence[Path]) -> str:
    """Return the hash of all a study is made of."""
    total = hashlib.sha256()
    for one in inputs:
        total.update(one.name.encode() + b"\0")
        try:
            with one.open("rb") as file:
                total.update(hashlib.file_digest(file, "sha256").digest())
        except OSError:
            total.update(b"missing")
    return total.hexdigest()
