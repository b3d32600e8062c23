"""The marks of a chart by matplotlib: lines, points, bars, bands, links, cells."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from acquisition.arrays import FloatArray
from modalkit.figures.style import NAMED, PROBABILITY, SIGNED, SMALL, ink_on
from modalkit.views.chart import Chart, Series

MARKERS = {"dot": "o", "square": "s", "diamond": "D", "down": "v", "up": "^", "cross": "x", "right": ">"}
"""Marks by the names that charts use."""

PIXEL = 0.75
"""A pixel of the browser on paper [pt]."""


def draw_series(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    """Draw a series in a panel; what has a higher ``order`` lies above."""
    _KINDS[series.kind](axes, series, chart, order)


def _numbers(values: Any) -> FloatArray:
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def _named(series: Series) -> str | None:
    return None if series.more.get("unnamed") or not series.name else series.name


def _line(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    more = series.more
    clamp = series.colour == "clamp"
    axes.plot(
        _numbers(series.x), _numbers(series.y), color=NAMED[series.colour], label=_named(series), zorder=order,
        linewidth=6.0 if clamp else more.get("width", 1.4), linestyle=(0, (4, 2)) if more.get("dash") else "solid",
        solid_capstyle="butt" if clamp else "round",
    )  # fmt: skip


def _points(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    more, colour = series.more, NAMED[series.colour]
    x, y = _numbers(series.x), _numbers(series.y)
    if "error" in more:
        axes.errorbar(x, y, yerr=_numbers(more["error"]), fmt="none", ecolor=colour, capsize=3, zorder=order)
    if "top" in more:
        axes.vlines(
            x,
            _numbers(more["bottom"]),
            _numbers(more["top"]),
            color=colour,
            linewidth=1.4,
            alpha=0.45,
            zorder=order,
        )
    face: dict[str, Any] = {"color": colour, "linewidth": 1.0}
    symbol = MARKERS[more.get("symbol", "dot")]
    if more.get("hollow"):
        face = {"facecolor": "white", "edgecolor": colour, "linewidth": 1.5}
    elif symbol != "x":
        face = {"facecolor": colour, "edgecolor": "white", "linewidth": 0.6 * (more.get("size", 4.0) >= 4)}
    side = 2 * PIXEL * _numbers(more.get("sizes", [more.get("size", 4.0)]))
    axes.scatter(x, y, s=side**2, marker=symbol, label=_named(series), zorder=order, clip_on=False, **face)


def _bars(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    """Draw bars from zero: lying where the upright axis has names, else upright."""
    colours = [NAMED[c] for c in series.more.get("colours", [series.colour] * len(series.y))]
    x, y = _numbers(series.x), _numbers(series.y)
    if chart.y.names:
        axes.barh(y, x, height=0.55, color=colours, label=_named(series), zorder=order)
    else:
        apart = np.diff(np.unique(x)).min(initial=np.inf)
        axes.bar(
            x,
            y,
            0.55 * (apart if np.isfinite(apart) else 1.0),
            color=colours,
            label=_named(series),
            zorder=order,
        )


def _bands(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    low, high = _numbers(series.more["low"]), _numbers(series.more["high"])
    axes.barh(
        _numbers(series.y), high - low, left=low, height=0.64, color=NAMED[series.colour], label=_named(series),
        zorder=order,
    )  # fmt: skip


def _links(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    low, high = _numbers(series.more["low"]), _numbers(series.more["high"])
    colour, name = NAMED[series.colour], _named(series) or ""
    axes.hlines(_numbers(series.y), low, high, linewidth=2.2, zorder=order, color=colour, label=name)


def _cells(axes: Axes, series: Series, chart: Chart, order: float) -> None:
    """Draw rectangles shaded by their value, and write into those what has room."""
    more = series.more
    low, high, bottom, top, value = (_numbers(more[k]) for k in ("low", "high", "bottom", "top", "value"))
    written = more.get("written", [""] * len(value))
    figure = axes.get_figure(root=True)
    assert figure is not None
    inches = axes.get_position().width * figure.get_size_inches()[0]
    axes.set_xlim(axes.get_xlim() if chart.x.range else (float(low.min()), float(high.max())))
    scale = inches / abs(axes.get_xlim()[1] - axes.get_xlim()[0])
    for a, b, c, d, v, text in zip(low, high, bottom, top, value, written, strict=True):
        colour = "white" if np.isnan(v) else PROBABILITY(v) if v >= 0 else SIGNED(0.5 - 0.5 * v)
        axes.add_patch(
            Rectangle((a, c), b - a, d - c, facecolor=colour, edgecolor="white", linewidth=1.2, zorder=order)
        )
        size = min(SMALL, 72 * scale * (b - a) / max(0.62 * len(text), 1.8))
        if text and size > 3.0:
            axes.text(
                (a + b) / 2,
                (c + d) / 2,
                text,
                fontsize=size,
                color=ink_on(colour),
                ha="center",
                va="center",
                zorder=order,
            )


_KINDS = {
    "line": _line,
    "points": _points,
    "bars": _bars,
    "bands": _bands,
    "links": _links,
    "cells": _cells,
}
