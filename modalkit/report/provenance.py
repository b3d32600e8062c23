"""What a report rests on: files with their fingerprints, versions, date, the study's text."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from modalkit.report.html import Cell, Column, Raw, element, joined, table
from modalkit.study.read import Study
from modalkit.workflow.case import Session

PACKAGES = ("modalkit-ema", "numpy", "scipy", "sdypy-EMA", "pyuff")
"""Packages whose versions are told."""


def provenance(sessions: Sequence[Session], when: datetime) -> Raw:
    """Return files, versions, date and study texts.

    Parameters
    ----------
    sessions : sequence of Session
        What was diagnosed.
    when : datetime
        Date of the report.
    """
    statement = f"Written {when.isoformat(sep=' ', timespec='seconds')} by {_versions()}."
    parts = [element("p", statement)]
    for session in sessions:
        study = session.study
        parts += [_files(study), element("h3", f"The study file {study.path.name}"), _text(study.path)]
    return joined(*parts)


def _versions() -> str:
    found = []
    for name in PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(f"{name} (not installed)")
    return ", ".join([*found, f"Python {platform.python_version()}"])


def _files(study: Study) -> Raw:
    rows: list[list[Cell | Raw]] = []
    for path in dict.fromkeys(study.inputs()):
        try:
            size, digest = path.stat().st_size, fingerprint(path)
        except OSError:
            rows.append([_named(study, path), None, "not there any more"])
            continue
        rows.append([_named(study, path), size, element("code", digest)])
    columns = [Column("file"), Column("bytes", lambda value: f"{value:.0f}"), Column("sha256")]
    return table(f"Files of {study.name}, as they are on the day of this report.", columns, rows)


def _named(study: Study, path: Path) -> str:
    """Return a file by its path from the study's folder, which is what the study says."""
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
        return element("p", "It cannot be read any more.")
    return Raw(element("pre", content).markup.replace("<br>", "\n"))
