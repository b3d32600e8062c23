"""A chart as data: matplotlib draws it on paper, static/chart.js in the browser, where its numbers can be read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from acquisition.arrays import AnyArray

DIGITS = 5
"""Digits of a number that is drawn: a screen shows three, and the CSV ought to hold what is known of it. One more adds
a tenth to the size of a report [-]."""

Kind = Literal["line", "points", "bars", "bands", "links", "cells"]
Numbers = Sequence[float | None] | AnyArray


@dataclass(frozen=True)
class Axis:
    """An axis.

    Parameters
    ----------
    title : str
        With its unit.
    log : bool
        Whether it is logarithmic.
    range : tuple of float, optional
        Its ends; left out: those of the data.
    names : tuple of str
        Names in place of numbers; values are their places then.
    zero : bool
        Whether it begins at 0 where nothing is negative.
    ticks : tuple of float
        Where its numbers stand on paper; left out: evenly. A browser places them itself.
    """

    title: str = ""
    log: bool = False
    range: tuple[float, float] | None = None
    names: tuple[str, ...] = ()
    zero: bool = False
    ticks: tuple[float, ...] = ()

    def data(self) -> dict[str, Any]:
        """Return what is drawn."""
        found = {"title": self.title, "log": self.log, "range": self.range, "zero": self.zero}
        optional = {"names": self.names, "ticks": self.ticks}
        return found | {name: value for name, value in optional.items() if value}


@dataclass(frozen=True, eq=False)
class Series:
    """Marks of one kind and colour.

    Parameters
    ----------
    name : str
        In the key; "" for none.
    kind : str
        line, points, bars, bands and links (from ``low`` to ``high`` in a row), or cells (rectangles with a value).
    x, y : sequences
        Places; ``x`` may be left out where the chart's choices share it.
    colour : str
        One of the page: blue, orange, green, red, muted, faint, ink, pale, band.
    more : dict
        What else the kind has: error, low, high, bottom, top (of points the ends of an interval), value, written,
        text, colours, sizes, modes (sequences; the last are the numbers of modes that marks stand for); symbol, size,
        width, hollow, dash, right (behind, on a logarithmic axis of its own), panel (on paper alone: 1 for the first
        below), unnamed.
    """

    name: str
    kind: Kind
    x: Numbers | None = None
    y: Numbers = ()
    colour: str = "blue"
    more: dict[str, Any] = field(default_factory=dict)

    def data(self) -> dict[str, Any]:
        """Return what is drawn."""
        found: dict[str, Any] = {
            "name": self.name,
            "kind": self.kind,
            "y": rounded(self.y),
            "colour": self.colour,
        }
        if self.x is not None:
            found["x"] = rounded(self.x)
        return found | {k: rounded(v) if k in _NUMBERS else v for k, v in self.more.items() if v is not None}


_NUMBERS = {"error", "low", "high", "bottom", "top", "value", "sizes"}


@dataclass(frozen=True, eq=False)
class Choices:
    """Sets of series of which one is shown at a time.

    Parameters
    ----------
    name : str
        What is chosen.
    items : sequence of (str, sequence of Series)
        Each with its name.
    x : sequence, optional
        What all of them share.
    """

    name: str
    items: Sequence[tuple[str, Sequence[Series]]]
    x: Numbers | None = None

    def data(self) -> dict[str, Any]:
        """Return what is drawn."""
        items = [{"name": name, "series": [one.data() for one in series]} for name, series in self.items]
        return {
            "name": self.name,
            "items": items,
            "x": None if self.x is None else rounded(self.x, DIGITS + 2),
        }


@dataclass(frozen=True, eq=False)
class Chart:
    """A chart.

    Parameters
    ----------
    name : str
        Of its element and of its file of data: letters, digits, hyphens.
    title, text : str
        What it shows, as a sentence made of its numbers, and what the marks are.
    x, y : Axis
        Its axes.
    series : sequence of Series
        Its marks, the lowest first.
    height : float
        Of its body, where no rows give it one [px].
    choices : Choices, optional
        Further series of which one set is shown.
    below : sequence of Axis
        On paper, upright axes of panels beneath, over the same places along. A browser has charts of their own there.
    more : dict
        ``lines``: places of dotted lines upright; ``modes``: the same for modes, which are numbered on paper;
        ``zero``: an axis at 0; ``equal``: height over width of what is drawn in true proportion; ``bare``: no axes;
        ``row``: height of a row, ``cell``: width of a column at the most [px]; ``notes``: a text for each row, which
        stands beside it on paper.
    """

    name: str
    title: str
    text: str
    x: Axis
    y: Axis
    series: Sequence[Series] = ()
    height: float = 300.0
    choices: Choices | None = None
    below: Sequence[Axis] = ()
    more: dict[str, Any] = field(default_factory=dict)

    def data(self) -> dict[str, Any]:
        """Return what is drawn."""
        found = {
            "name": self.name,
            "title": self.title,
            "text": self.text,
            "x": self.x.data(),
            "y": self.y.data(),
            "series": [one.data() for one in self.series],
            "height": self.height,
        }
        if self.below:
            found["below"] = [axis.data() for axis in self.below]
        return found | ({"choices": self.choices.data()} if self.choices is not None else {}) | self.more

    def on_paper(self) -> Chart:
        """Return the chart with the first of its choices in it, which its text then names."""
        if self.choices is None or not self.choices.items:
            return self
        item, series = self.choices.items[0]
        shown = [one if one.x is not None else replace(one, x=self.choices.x) for one in series]
        text = f"{self.choices.name} {item}. {self.text}"
        return replace(self, series=[*self.series, *shown], text=text, choices=None)


@dataclass(frozen=True, eq=False)
class Sheet:
    """Charts under one title.

    Parameters
    ----------
    title, text : str
        What they show together, and what the marks are.
    charts : sequence of Chart
        Each with its own title.
    """

    title: str
    text: str
    charts: Sequence[Chart]


def rounded(values: Any, digits: int = DIGITS) -> list[float | None]:
    """Return numbers in a few digits; what is not finite becomes None."""
    return [
        _rounded(value, digits) for value in (values.tolist() if isinstance(values, np.ndarray) else values)
    ]


def _rounded(value: float | None, digits: int) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    short = float(f"{value:.{digits}g}")
    if not math.isfinite(short):  # the largest there is, rounded up
        return value
    return int(short) if short == int(short) and abs(short) < 1e15 else short
