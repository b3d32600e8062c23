"""How the score of a blind run is printed and written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from modalkit.blind.scoring.markdown import BEGIN, END, into_page, score_markdown
from modalkit.blind.scoring.page import Section, sections
from modalkit.blind.scoring.score import Score
from modalkit.cli.common import out, show_table
from modalkit.output.destinations import Kind, check_output
from modalkit.output.whole import write_text


def _takes_a_score(path: Path) -> bool:
    """Return whether a page has the two marks, or is nothing but a score."""
    page = path.read_text(encoding="utf-8", errors="replace")
    return page.startswith("## What matters first\n") or (BEGIN in page and END in page)


MARKDOWN = Kind(f"a score, nor a page with the lines {BEGIN} and {END}", "score", ".md", _takes_a_score)
"""The kind of file that a score is written to."""


def show_score(score: Score) -> None:
    """Print the score of a blind run: the numbers that matter first, then the rest, then what failed.

    Parameters
    ----------
    score : Score
        Of a blind run.
    """
    for section in sections(score):
        _show(section)
    failed = score.trials[score.trials["verdict"] == "failed"]
    for index, row in failed.iterrows():
        out.print(f"failed: trial {index} ({row['effect']}): {row['failure']}", markup=False)


def _show(section: Section) -> None:
    out.print(section.title, style="bold", markup=False)
    if section.note:
        out.print(section.note, style="dim", markup=False)
    show_table(section.table)


def write_markdown(path: Path, score: Score) -> None:
    """Write the score as markdown; a page that has the two marks keeps what stands around them.

    Parameters
    ----------
    path : Path
        The file: a new one, or a page with marks.
    score : Score
        Of a blind run.

    Raises
    ------
    InputError
        If it cannot be written, or another page stands there.
    """
    check_output(path, MARKDOWN)
    page = path.read_text(encoding="utf-8") if path.is_file() else ""
    marked = BEGIN in page and END in page
    write_text(path, into_page(page, score) if marked else score_markdown(score, level=2))


def score_figures(score: Score) -> dict[str, Any]:
    """Return the figures of a score by file name."""
    from modalkit.figures import blind_figures

    return blind_figures(score)
