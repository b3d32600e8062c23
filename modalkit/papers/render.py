"""Tables of a paper as Markdown, CSV or LaTeX."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import pandas as pd

from acquisition import InputError

Format = Literal["md", "csv", "latex"]

DIGITS = {"factor": 4, "MAC": 1, "damping": 3}
"""Decimals of columns that have not two, by the start of their names [-]."""

WORDS = ("model", "parameter", "erratum", "variant", "study", "unit", "point")
"""Columns of text, which stand left."""


@dataclass(frozen=True, eq=False)
class PaperTable:
    """A table of a paper, worked out anew.

    Parameters
    ----------
    paper : str
        A or B.
    number, title : int or str, str
        As in the paper; a word for a table that the paper has not.
    table : DataFrame
        One row per mode and model: printed values, and ours beside them (nan where there is none); the last
        column names errata.
    factors : DataFrame
        Updated parameters, printed and ours; may be empty.
    notes : tuple of str
        What to know.
    """

    paper: str
    number: int | str
    title: str
    table: pd.DataFrame
    factors: pd.DataFrame
    notes: tuple[str, ...]

    @property
    def heading(self) -> str:
        """Title with the paper's number."""
        name = f"Table {self.number}" if isinstance(self.number, int) else self.number
        return f"Paper {self.paper}, {name}: {self.title}"

    @property
    def blocks(self) -> tuple[pd.DataFrame, ...]:
        """Rows and parameters, those that there are."""
        return tuple(frame for frame in (self.table, self.factors) if len(frame))


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
    columns = [[_cell(v, _digits(str(name))) for v in frame[name]] for name in frame.columns]
    return [list(row) for row in zip(*columns, strict=True)]


def _digits(name: str) -> int:
    return next((digits for start, digits in DIGITS.items() if name.startswith(start)), 2)


def _cell(value: object, digits: int) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.{digits}f}"
    return str(value)


def _is_text(name: str) -> bool:
    return name in WORDS


def _markdown(made: PaperTable) -> str:
    notes = "".join(f"- {note}\n" for note in made.notes)
    return f"## {made.heading}\n\n" + "\n".join([*(_pipes(frame) for frame in made.blocks), notes])


def _pipes(frame: pd.DataFrame) -> str:
    names = [str(n) for n in frame.columns]
    cells = _cells(frame)
    lines = [names, ["---" if _is_text(n) else "---:" for n in names], *cells]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _csv(made: PaperTable) -> str:
    """Write the rows, then the factors, at full precision, each line led by paper and table."""
    parts = []
    for frame in made.blocks:
        led = frame.copy()
        led.insert(0, "table", made.number)
        led.insert(0, "paper", made.paper)
        parts.append(led.to_csv(index=False, lineterminator="\n"))
    return "\n".join(parts)


def _latex(made: PaperTable) -> str:
    blocks = [_tabular(frame) for frame in made.blocks]
    notes = "".join(f"\\par {_escaped(note)}\n" for note in made.notes)
    body = "\n\\medskip\n\n".join(blocks)
    return f"\\begin{{table}}\n\\caption{{{_escaped(made.heading)}}}\n{body}{notes}\\end{{table}}\n"


def _tabular(frame: pd.DataFrame) -> str:
    names = [str(n) for n in frame.columns]
    align = "".join("l" if _is_text(n) else "r" for n in names)
    lines = [[_escaped(n) for n in names], *[[_escaped(c) for c in row] for row in _cells(frame)]]
    body = " \\\\\n".join(" & ".join(line) for line in lines)
    return f"\\begin{{tabular}}{{{align}}}\n{body} \\\\\n\\end{{tabular}}\n"


ESCAPES = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "{": r"\{",
        "}": r"\}",
        "%": r"\%",
        "&": r"\&",
        "_": r"\_",
        "#": r"\#",
        "^": r"\textasciicircum{}",
    }
)
"""What LaTeX would take for its own."""


def _escaped(text: str) -> str:
    return text.translate(ESCAPES)
