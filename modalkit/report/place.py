"""Where a report is written: whole or not at all, and over no file that is none."""

from __future__ import annotations

from pathlib import Path

from acquisition.errors import InputError
from modalkit.write import check_place, write_text

DOCTYPE = "<!doctype html>"
"""How every report begins."""


def check_report_place(path: Path | None) -> None:
    """See that a report could be written, and that no other file stands there; None is no report.

    Raises
    ------
    InputError
        If one does, or the folder cannot be written.
    """
    check_place(path)
    if path is None or not path.is_file() or not path.stat().st_size:
        return
    with path.open("rb") as file:
        begins = file.read(200).lstrip().lower()
    if not begins.startswith(DOCTYPE.encode()):
        raise InputError(f"{path}: stands there and is no HTML file; name another file for the report")


def write_report(path: Path, text: str) -> None:
    """Write a report in one step.

    Raises
    ------
    InputError
        If it cannot be written, or another file than HTML stands there.
    """
    check_report_place(path)
    write_text(path, text)
