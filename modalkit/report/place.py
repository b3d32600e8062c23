"""Where a report is written: whole or not at all, and over no file that is none."""

from __future__ import annotations

from pathlib import Path

from modalkit.output.destinations import check_output, text_of
from modalkit.output.whole import write_text

BEGIN = '<!doctype html>\n<html lang="en">\n<head><meta name="generator" content="modalkit">'
"""How every report begins."""

REPORT = text_of("a report written by modalkit", "report", ".html", BEGIN)
"""The kind of file."""


def write_report(path: Path, text: str) -> None:
    """Write a report in one step.

    Raises
    ------
    InputError
        If it cannot be written, or something else than a report stands there.
    """
    check_output(path, REPORT)
    write_text(path, text)
