"""What the app was started with: a study, or a data file that is made one."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition.errors import InputError, StudyError
from modalkit.study.read import Study, read_study, study_of

FILES = (("test", "files"), ("baseline", "files"), ("model", "stiffness_parts"), ("model", "mass_parts"))
"""Keys of a study that list files."""

FILE = (
    *((table, key) for table in ("test", "baseline") for key in ("modes", "layout")),
    *(("model", key) for key in ("stiffness", "mass", "mass_matrix", "nodes", "deck")),
)
"""Keys that name one."""

OF_HYPOTHESES = ("stiffness", "mass", "deck")
"""The same in each ``[[hypothesis]]``."""


@dataclass(frozen=True)
class Opened:
    """A study or a data file.

    Parameters
    ----------
    path : Path
        The file.
    study_path : Path
        Where the study stands, or would stand: its files are relative to it.
    content : dict
        The tables of the study.
    """

    path: Path
    study_path: Path
    content: dict[str, Any]

    @property
    def is_study(self) -> bool:
        """Whether a study was opened."""
        return self.path == self.study_path

    def study(self, content: Mapping[str, Any]) -> Study:
        """Return the study that some tables are, with no file in it but those of the folder and those it began with.

        Raises
        ------
        StudyError
            If a key or value does not belong there, or a file lies elsewhere.
        """
        known = set(files_of(self.content))
        folder = self.study_path.parent.resolve()
        for name in files_of(content):
            if name not in known and not (folder / name).resolve().is_relative_to(folder):
                raise StudyError(
                    f"{name}: lies outside the study's folder; copy it there, or start the app again"
                )
        return study_of(dict(content), self.study_path)


def files_of(content: Mapping[str, Any]) -> list[str]:
    """Return the names of files that the tables of a study hold; what is no text is no name."""
    names: list[Any] = []
    for table, key in FILES:
        listed = _table(content, table).get(key, [])
        names += listed if isinstance(listed, list) else [listed]
    names += [_table(content, table).get(key) for table, key in FILE]
    names += [entry.get(key) for entry in _hypotheses(content) for key in OF_HYPOTHESES]
    return [name for name in names if isinstance(name, str)]


def relocated(content: Mapping[str, Any], old: Path, new: Path) -> dict[str, Any]:
    """Return the tables of a study with its files named from another folder.

    Parameters
    ----------
    content : mapping
        The tables.
    old, new : Path
        The folder they are named from, and that they are to be named from.
    """

    def moved(name: Any) -> Any:
        if not isinstance(name, str):
            return name
        return Path(os.path.relpath((old / name).resolve(), new.resolve())).as_posix()

    changed = {k: dict(v) if isinstance(v, Mapping) else v for k, v in content.items()}
    for table, key in FILES:
        if isinstance(listed := _table(changed, table).get(key), list):
            changed[table][key] = [moved(name) for name in listed]
    for table, key in FILE:
        if isinstance(name := _table(changed, table).get(key), str):
            changed[table][key] = moved(name)
    if _hypotheses(changed):
        changed["hypothesis"] = [
            {k: moved(v) if k in OF_HYPOTHESES else v for k, v in entry.items()}
            for entry in _hypotheses(changed)
        ]
    return changed


def _hypotheses(content: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the user's own effects, some of which name files."""
    listed = content.get("hypothesis", [])
    return [entry for entry in listed if isinstance(entry, Mapping)] if isinstance(listed, list) else []


def _table(content: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    table = content.get(name, {})
    return table if isinstance(table, Mapping) else {}


def open_path(path: Path, *, layout: Path | None = None) -> Opened:
    """Open a study or a data file.

    Parameters
    ----------
    path : Path
        A ``.toml`` is a study, anything else a file of hits, FRFs or modes.
    layout : Path, optional
        Of column text.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    if path.suffix.lower() == ".toml":
        if layout is not None:
            raise StudyError(
                f"{path}: --layout is not for studies; name the layout under [test] in the study"
            )
        read_study(path)
        return Opened(path, path, tomllib.loads(path.read_text(encoding="utf-8-sig")))
    if not path.is_file():
        raise InputError(f"{path}: there is no such file; give a study or a file of hits, FRFs or modes")
    return Opened(path, path.with_suffix(".toml"), {"test": _test(path, layout)})


def _test(path: Path, layout: Path | None) -> dict[str, Any]:
    """Return the table of a test whose data a file holds."""
    from modalkit.workflow.files import read_files

    content = read_files(path, layout=layout)
    only_modes = content.modal is not None and not content.tests and content.frfs is None
    named: dict[str, Any] = {"modes": path.name} if only_modes else {"files": [path.name]}
    if layout is not None:
        named["layout"] = Path(os.path.relpath(layout.resolve(), path.parent.resolve())).as_posix()
    return named
