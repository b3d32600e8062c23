"""What a report rests on: files with their fingerprints, versions, date, the study's text."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from acquisition.display import named_files
from modalkit.report.html import Cell, Column, Raw, definitions, element, joined, table
from modalkit.study.read import Study
from modalkit.version import __version__

PACKAGES = ("modalkit-ema", "numpy", "scipy", "sdypy-EMA", "pyuff")
"""Packages whose versions are stated."""

AUTHOR = "MODALKIT_AUTHOR"
"""Environment variable that names the author of reports whose studies name none."""


@dataclass(frozen=True, eq=False)
class Basis:
    """What a report rests on.

    Parameters
    ----------
    when : datetime
        Date of the report.
    command : str
        What repeats it; "" for none.
    studies : sequence of Study
        The studies.
    files : sequence of Path
        Files that no study names.
    settings : mapping of str to str
        What was stated beside the studies, in words.
    """

    when: datetime
    command: str = ""
    studies: Sequence[Study] = ()
    files: Sequence[Path] = ()
    settings: Mapping[str, str] = field(default_factory=dict)


def cover(kind: str, basis: Basis) -> Raw:
    """Return the line under the title: what is reported, of what, by whom, when, with which version.

    The author is the one that the studies state, else that of the environment variable ``MODALKIT_AUTHOR``.

    Parameters
    ----------
    kind : str
        What is reported.
    basis : Basis
        What it rests on.
    """
    files = [study.path.name for study in basis.studies] or [path.name for path in basis.files]
    whose = [study.author for study in basis.studies if study.author] or [os.environ.get(AUTHOR, "")]
    parts = [
        kind + (f" ({named_files(files)})" if files else ""),
        ", ".join(dict.fromkeys(name for name in whose if name)),
        f"{basis.when.day} {basis.when:%B %Y}",
        f"modalkit {__version__}",
    ]
    return element("p", " · ".join(part for part in parts if part), class_="cover")


def provenance(basis: Basis) -> Raw:
    """Return the command, settings, files with their fingerprints, versions, date and study texts."""
    written = f"Written {basis.when.isoformat(sep=' ', timespec='seconds')} by {_versions()}."
    parts = [element("p", written)]
    if basis.command:
        parts += [element("h3", "To repeat it"), element("pre", basis.command)]
    if basis.settings:
        parts.append(definitions(basis.settings, class_="settings"))
    if basis.files:
        files = [(path.name, path) for path in basis.files]
        parts.append(_files("Files, as they are on the day of this report.", files))
    for study in basis.studies:
        names = [(_named(study, path), path) for path in dict.fromkeys(study.inputs())]
        parts.append(_files(f"Files of {study.name}, as they are on the day of this report.", names))
        parts += [element("h3", f"The study file {study.path.name}"), _text(study.path)]
    return joined(*parts)


def _versions() -> str:
    found = []
    for name in PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(f"{name} (not installed)")
    return ", ".join([*found, f"Python {platform.python_version()}"])


def _files(caption: str, files: Sequence[tuple[str, Path]]) -> Raw:
    rows: list[list[Cell | Raw]] = []
    for name, path in files:
        try:
            size, digest = path.stat().st_size, fingerprint(path)
        except OSError:
            rows.append([name, None, "no longer there"])
            continue
        rows.append([name, size, element("code", digest)])
    columns = [Column("file"), Column("bytes", lambda value: f"{value:.0f}"), Column("sha256")]
    return table(caption, columns, rows)


def _named(study: Study, path: Path) -> str:
    """Return a file by its path from the study's folder, which is what the study states."""
    folder = study.path.parent
    return str(path.relative_to(folder)) if path.is_relative_to(folder) else path.name


def fingerprint(path: Path) -> str:
    """Return the SHA-256 of a file, read piece by piece."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _text(path: Path) -> Raw:
    try:
        content = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError):
        return element("p", "It can no longer be read.")
    return Raw(element("pre", content).markup.replace("<br>", "\n"))
