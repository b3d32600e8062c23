"""The few elements a report is made of; all text that goes in is escaped."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

Cell = str | float | int | None


_UNBROKEN = re.compile(r"-&gt;|\d[\d.]{0,20}e-\d{1,4}\b")
"""Where a browser would end a line behind the minus sign."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Parameters
    ----------
    name : str
        Its heading.
    write : function, optional
        How a number is written; columns with it are numbers, to the right.
    wide : bool
        Whether it holds long texts.
    """

    name: str
    write: Callable[[float], str] | None = None
    wide: bool = False


@dataclass(frozen=True)
class Raw:
    """Markup that is safe already."""

    markup: str


def text(value: object) -> str:
    """Escape a text; a newline in it ends a line, and no line ends within an arrow or a power of ten."""
    whole = _UNBROKEN.sub(r'<span class="one">\g<0></span>', escape(str(value), quote=True))
    return whole.replace("\n", "<br>")


def element(tag: str, *inside: str | Raw, **attributes: str) -> Raw:
    """Return an element; plain text inside it is escaped, ``class_`` is written as ``class``."""
    stated = "".join(
        f' {k.rstrip("_").replace("_", "-")}="{escape(v, quote=True)}"' for k, v in attributes.items() if v
    )
    if tag in frozenset({"img", "br"}):  # elements that nothing stands in
        return Raw(f"<{tag}{stated}>")
    return Raw(
        f"<{tag}{stated}>{''.join(i.markup if isinstance(i, Raw) else text(i) for i in inside)}</{tag}>"
    )


def joined(*parts: Raw) -> Raw:
    """Return pieces of markup one after the other."""
    return Raw("\n".join(part.markup for part in parts if part.markup))


def bullets(items: Sequence[str]) -> Raw:
    """Return a list."""
    return element("ul", *(element("li", item) for item in items)) if items else Raw("")


def table(
    caption: str,
    columns: Sequence[Column],
    rows: Sequence[Sequence[Cell | Raw]],
    *,
    marked: Sequence[bool] = (),
) -> Raw:
    """Return a table whose first column heads its rows.

    Parameters
    ----------
    caption : str
        What it shows.
    columns : sequence of Column
        Its columns.
    rows : sequence of sequences
        Cells; None and nan are a dash.
    marked : sequence of bool, optional
        Rows that are the answer.
    """
    head = element("tr", *(element("th", c.name, scope="col", class_=_class(c)) for c in columns))
    body = []
    for i, row in enumerate(rows):
        cells = [_cell(v, c, first=k == 0) for k, (v, c) in enumerate(zip(row, columns, strict=True))]
        body.append(element("tr", *cells, class_="answer-row" if i < len(marked) and marked[i] else ""))
    whole = element("table", element("caption", caption), element("thead", head), element("tbody", *body))
    return element("div", whole, class_="scroll", tabindex="0", role="region", aria_label=caption)


def definitions(items: Mapping[str, str], *, class_: str = "") -> Raw:
    """Return a list of terms and their explanations."""
    pairs = [part for k, v in items.items() for part in (element("dt", k), element("dd", v))]
    return element("dl", *pairs, class_=class_)


def folded(summary: str, inside: Raw) -> Raw:
    """Return what is shown once it is asked for; print shows it as the reader left it."""
    return element("details", element("summary", summary), inside)


def _class(column: Column) -> str:
    return "n" if column.write is not None else "wide" if column.wide else ""


def _cell(value: Cell | Raw, column: Column, *, first: bool) -> Raw:
    text: str | Raw
    if isinstance(value, Raw):
        text = value
    elif value is None or (isinstance(value, float) and math.isnan(value)):
        text = "–"
    elif isinstance(value, int | float) and column.write is not None:
        text = column.write(float(value))
    else:
        text = str(value)
    if first:
        return element("th", text, scope="row", class_=_class(column))
    return element("td", text, class_=_class(column))
