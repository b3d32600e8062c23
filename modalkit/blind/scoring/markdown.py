"""The score as markdown, for the docs."""

from __future__ import annotations

import pandas as pd

from modalkit.blind.scoring.page import sections
from modalkit.blind.scoring.score import Score

BEGIN, END = "<!-- score: begin -->", "<!-- score: end -->"
"""Between these two lines the docs carry a score."""


def score_markdown(score: Score, *, level: int = 3) -> str:
    """Return the score as markdown.

    Parameters
    ----------
    score : Score
        Of a blind run.
    level : int
        Of the headings [-].

    Returns
    -------
    str
        One heading, note and table after the other.
    """
    parts = []
    for section in sections(score):
        parts.append(f"{'#' * level} {section.title}\n")
        if section.note:
            parts.append(f"{section.note[0].upper()}{section.note[1:]}.\n")
        parts.append(_pipes(section.table))
    return "\n".join(parts)


def into_page(page: str, score: Score) -> str:
    """Return a page of the docs with the score between its two marks; a page without them gets it at its end.

    Parameters
    ----------
    page : str
        Markdown.
    score : Score
        Of a blind run.
    """
    text = f"{BEGIN}\n\n{score_markdown(score)}\n{END}"
    if BEGIN not in page or END not in page:
        return f"{page.rstrip()}\n\n{text}\n" if page.strip() else text + "\n"
    before, rest = page.split(BEGIN, 1)
    return before + text + rest.split(END, 1)[1]


def _pipes(table: pd.DataFrame) -> str:
    lines = [_line(list(table.columns)), _line(["---"] * len(table.columns))]
    lines += [_line(list(row)) for row in table.itertuples(index=False)]
    return "\n".join(lines) + "\n"


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"
