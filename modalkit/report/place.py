"""Where a report is written: as HTML or Word by its ending, whole or not at all, over no file of another kind."""

from __future__ import annotations

from pathlib import Path

from modalkit.output.destinations import Kind, check_output, text_of
from modalkit.output.whole import write_bytes, write_text
from modalkit.report.document import Document
from modalkit.report.page import BEGIN, page
from modalkit.report.word import WORD, word

HTML = text_of("a report written by modalkit", "report", ".html", BEGIN)
"""Reports for a browser."""


def report_kind(path: Path) -> Kind:
    """Return the kind of report that a file is to be: Word where it ends in .docx, else HTML."""
    return WORD if path.suffix.lower() == WORD.ending else HTML


def write_report(path: Path, document: Document) -> None:
    """Write a report in one step.

    Parameters
    ----------
    path : Path
        The file; one that ends in .docx is written for Word.
    document : Document
        The report.

    Raises
    ------
    InputError
        If it cannot be written, something else than a report stands there, or a Word file is wanted and python-docx is
        not installed.
    """
    kind = report_kind(path)
    check_output(path, kind)
    if kind is WORD:
        write_bytes(path, word(document))
    else:
        write_text(path, page(document))
