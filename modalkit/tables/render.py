"""Tables of a paper as Markdown, CSV or LaTeX."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import pandas as pd

from acquisition import InputError

Format = Literal["md", "csv", "latex"]

DIGITS = {"factor": 4, "factor, ours": 4, "MAC [%]": 1, "MAC, ours": 1}
"""Decimals of columns that have not two [-]."""


@dataclass(frozen=True, eq=False)
class PaperTable:
    """A table of a paper, worked out anew.

    Parameters
    ----------
    paper : str
        A or B.
    number, title : int, str
        As in the paper.
    table : DataFrame
        One row per mode and model: printed values, and ours beside them (nan where there is none); the last
        column names errata.
    factors : DataFrame
        Updated parameters, printed and ours.
    notes : tuple of str
        What to know.
    """

    paper: str
    number: int
    title: str
    table: pd.DataFrame
    factors: pd.DataFrame
    notes: tuple[str, ...]

    @property
    def heading(self) -> str:
        """Title with the paper's number."""
        return f"Paper {self.paper}, Table {self.number}: {self.title}"


def tables(paper: str = "A") -> list[PaperTable]:
    """Work out a paper's tables from the sample tests: hits to FRFs to poles to pairs to the updated model.

    Parameters
    ----------
    paper : {"A"}
        Which paper.

    Raises
    ------
    InputError
        If the tables of that paper are not among those that this version makes.
    """
    if paper.upper() != "A":
        raise InputError(f"no tables of paper {paper!r} in this version; use --paper A")
    from modalkit.tables.paper_a import tables_a

    return tables_a()


def render(made: Sequence[PaperTable], form: Format = "md") -> str:
    """Print tables as text.

    Parameters
    ----------
    made : sequence of PaperTable
        The tables.
    form : {"md", "csv", "latex"}
        Markdown, comma-separated values, or LaTeX.

    Raises
    ------
    InputError
        If the format is unknown.
    """
    writers = {"md": _markdown, "csv": _csv, "latex": _latex}
    if form not in writers:
        raise InputError(f"no table format {form!r}; use md, csv or latex")
    return "\n".join(writers[form](table) for table in made)


def _cells(frame: pd.DataFrame) -> list[list[str]]:
    """Return the cells as text, empty where there is no value."""
    columns = [[_cell(v, str(name)) for v in frame[name]] for name in frame.columns]
    return [list(row) for row in zip(*columns, strict=True)]


def _cell(value: object, name: str) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.{DIGITS.get(name, 2)}f}"
    return str(value)


def _markdown(made: PaperTable) -> str:
    notes = "".join(f"- {note}\n" for note in made.notes)
    return f"## {made.heading}\n\n{_pipes(made.table)}\n{_pipes(made.factors)}\n{notes}"


def _pipes(frame: pd.DataFrame) -> str:
    names = [str(n) for n in frame.columns]
    cells = _cells(frame)
    text = [n in ("model", "parameter", "erratum") for n in names]
    lines = [names, ["---" if t else "---:" for t in text], *cells]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _csv(made: PaperTable) -> str:
    """Write the rows, then the factors, at full precision, each line led by paper and table."""
    parts = []
    for frame in (made.table, made.factors):
        led = frame.copy()
        led.insert(0, "table", made.number)
        led.insert(0, "paper", made.paper)
        parts.append(led.to_csv(index=False, lineterminator="\n"))
    return "\n".join(parts)


def _latex(made: PaperTable) -> str:
    blocks = [_tabular(made.table), _tabular(made.factors)]
    notes = "".join(f"\\par {_escaped(note)}\n" for note in made.notes)
    body = "\n\\medskip\n\n".join(blocks)
    return f"\\begin{{table}}\n\\caption{{{_escaped(made.heading)}}}\n{body}{notes}\\end{{table}}\n"


def _tabular(frame: pd.DataFrame) -> str:
    names = [str(n) for n in frame.columns]
    align = "".join("l" if n in ("model", "parameter", "erratum") else "r" for n in names)
    lines = [[_escaped(n) for n in names], *[[_escaped(c) for c in row] for row in _cells(frame)]]
    body = " \\\\\n".join(" & ".join(line) for line in lines)
    return f"\\begin{{tabular}}{{{align}}}\n{body} \\\\\n\\end{{tabular}}\n"


def _escaped(text: str) -> str:
    for plain, escaped in (
        ("\\", r"\textbackslash{}"),
        ("%", r"\%"),
        ("&", r"\&"),
        ("_", r"\_"),
        ("#", r"\#"),
    ):
        text = text.replace(plain, escaped)
    return text
