"""Write a study without what its name, title and comments reveal."""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path
from typing import Any

from acquisition.errors import StudyError
from modalkit.papers.real.case import Source

_MATRICES = ("stiffness", "mass_matrix", "mass", "nodes", "deck", "stiffness_parts", "mass_parts")
_FILES = {"test": ("files", "modes"), "baseline": ("files", "modes"), "model": _MATRICES}
"""Keys of each table of a study that name files. A mass of the model may be a list of bodies instead."""

_HEADER = re.compile(r"^\s*\[\[?\s*([\w.]+)\s*\]\]?")


def write_anonymous(source: Source, home: Path | None, folder: Path, number: int) -> Path:
    """Copy a study and its data under names that say nothing.

    Parameters
    ----------
    source : Source
        The study.
    home : Path or None
        Folder its path starts from, where it has one.
    folder : Path
        Where the copy goes.
    number : int
        Of the study in its case [-].

    Returns
    -------
    Path
        The study file.

    Raises
    ------
    StudyError
        If it cannot be read.
    """
    original = (home or Path()) / (source.path or Path())
    try:
        text = source.text or original.read_text(encoding="utf-8")
        text = without_tables(text, source.drop)
        document = tomllib.loads(text)
    except (OSError, ValueError, RecursionError) as error:
        raise StudyError(f"{original}: cannot be read ({error})") from error
    held = dict(source.tables)
    for i, name in enumerate(data_files(document)):
        copied = f"test{number}-{i}{Path(name).suffix}"
        if name in held:
            (folder / copied).write_text(held[name], encoding="utf-8")
        else:
            _copy(original.parent / name, folder / copied)
        text = text.replace(f'"{name}"', f'"{copied}"')
    study = folder / f"study{number}.toml"
    study.write_text(_untitled(text, number), encoding="utf-8")
    return study


def without_tables(text: str, drop: tuple[str, ...]) -> str:
    """Return a study without some of its tables, and without comments on lines of their own."""
    lines, keep = [], True
    for line in text.splitlines():
        header = _HEADER.match(line)
        if header:
            keep = header.group(1).split(".")[0] not in drop
        if keep and not line.lstrip().startswith("#"):
            lines.append(line)
    return "\n".join(lines) + "\n"


def data_files(document: dict[str, Any]) -> list[str]:
    """Return the files that a study names: of the test and the baseline, and the model's matrices or deck."""
    names: list[Any] = []
    for table in ("test", "baseline", "model"):
        part = document.get(table, {})
        for key in _FILES[table]:
            stated = part.get(key, [])
            names += [stated] if isinstance(stated, str) else stated
    return list(dict.fromkeys(name for name in names if isinstance(name, str)))


def _untitled(text: str, number: int) -> str:
    title = f'title = "Test {number}"'
    text, found = re.subn(r"^\s*title\s*=.*$", title, text, count=1, flags=re.MULTILINE)
    return text if found else f"{title}\n{text}"


def _copy(file: Path, target: Path) -> None:
    """Copy a file; of a table of modes without its comments."""
    try:
        if file.suffix.lower() != ".csv":
            shutil.copyfile(file, target)
            return
        lines = file.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise StudyError(f"{file}: cannot be read ({error.strerror})") from error
    target.write_text("\n".join(line for line in lines if not line.startswith("#")) + "\n", encoding="utf-8")
