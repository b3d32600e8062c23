"""Charts by matplotlib: one on a page of its own, several under one title, one in a panel of a larger figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from modalkit.figures.marks import draw_series
from modalkit.figures.modes import mark_modes
from modalkit.figures.style import (
    HEAD,
    INK,
    MARGIN,
    MUTED,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    heading,
    key,
    key_lines,
    new_figure,
    place,
    shortened,
    text_width,
    tidy,
)
from modalkit.views.chart import Axis, Chart, Series, Sheet

TALL, BELOW, GAP = 3.6, 0.7, 0.15
"""Heights of a chart without rows and of a panel beneath it, and the space between them [in]."""

KEY, NUMBERS, UNDER = 0.24, 0.22, 0.62
"""Heights of a line of the key, of the numbers of modes, and of an axis with its title [in]."""

NAMES = 4.2
"""Most width of the names of rows [in]."""

CELL = (0.16, 0.62)
"""Least and most side of a cell of a matrix [in]."""


def chart_figure(chart: Chart, *, title: str = "", note: str = "", beneath: Sequence[str] = ()) -> Figure:
    """Draw a chart on a page of its own.

    Parameters
    ----------
    chart : Chart
        The chart.
    title, note : str
        In place of those of the chart.
    beneath : sequence of str
        Lines of text under it.

    Returns
    -------
    Figure
    """
    title, note = title or chart.title, note or chart.text
    left, right = MARGIN + names_width(chart), MARGIN + _notes_width(chart)
    wide, width = WIDTH - left - right, WIDTH
    if "cell" in chart.more:
        wide = _side(chart) * len(chart.x.names)
        width = max(left + wide + right, 7.0)
    tall = chart_height(chart, wide)
    top = caption_height(title, note, width=width) + above(chart, wide) + 0.1
    line = 1.9 * SMALL / 72 / 1.35
    figure = new_figure(top + tall + under(chart) + line * len(beneath) + 0.1 * bool(beneath), width=width)
    caption(figure, title, note)
    draw_chart(figure, chart, left=left, top=top, width=wide, height=tall)
    high = figure.get_size_inches()[1]
    for k, text in enumerate(beneath):
        down = 1 - (top + tall + under(chart) + line * k) / high
        figure.text(MARGIN / width, down, text, fontsize=SMALL, color=MUTED, va="top")
    return figure


def sheet_figure(sheet: Sheet, *, columns: int = 2, tall: float = 0.0) -> Figure:
    """Draw several charts under one title, from left to right and from above to below.

    Parameters
    ----------
    sheet : Sheet
        The charts.
    columns : int
        Most charts beside each other.
    tall : float
        Height of each; 0 for its own [in].

    Returns
    -------
    Figure
    """
    columns = min(columns, len(sheet.charts))
    lefts = max(names_width(chart) for chart in sheet.charts)
    rights = max(_notes_width(chart) for chart in sheet.charts)
    width = (WIDTH - 2 * MARGIN) / columns - lefts - rights - 0.2 * (columns > 1)
    heights = [tall or chart_height(chart, width) for chart in sheet.charts]
    over = 0.25 + max(above(chart, width) for chart in sheet.charts)
    blocks = [over + h + under(chart) + 0.1 for chart, h in zip(sheet.charts, heights, strict=True)]
    rows = [max(blocks[k : k + columns]) for k in range(0, len(blocks), columns)]
    top = caption_height(sheet.title, sheet.text) + 0.1
    figure = new_figure(top + sum(rows))
    caption(figure, sheet.title, sheet.text)
    step = (WIDTH - 2 * MARGIN + 0.2 * (columns > 1)) / columns
    for i, (chart, height) in enumerate(zip(sheet.charts, heights, strict=True)):
        left, down = MARGIN + (i % columns) * step, top + sum(rows[: i // columns])
        room = 72 * (step - 0.2 * (columns > 1))
        heading(figure, left, down + 0.18, shortened(chart.title, room, HEAD, weight="bold"))
        draw_chart(
            figure, chart, left=left + lefts, top=down + over, width=_body(chart, width), height=height,
            name=chart.title,
        )  # fmt: skip
    return figure


def draw_chart(
    figure: Figure, chart: Chart, *, left: float, top: float, width: float, height: float, name: str = ""
) -> list[Axes]:
    """Draw a chart with its key and the panels beneath it in a figure, and return the panels.

    Parameters
    ----------
    figure : Figure
        The figure.
    chart : Chart
        The chart; a set that is chosen is not drawn.
    left, top, width, height : float
        The body of it with the panels beneath, from the figure's top left corner [in].
    name : str
        Of the panels, in place of that of the chart.
    """
    main = height - len(chart.below) * (BELOW + GAP)
    tops = [top, *(top + main + GAP + k * (BELOW + GAP) for k in range(len(chart.below)))]
    panels = []
    for k, (axis, down) in enumerate(zip((chart.y, *chart.below), tops, strict=True)):
        label = f"{name or chart.name}{f' {axis.title}' if k else ''}"
        panels.append(place(figure, left, down, width, BELOW if k else main, name=label))
        own = [one for one in chart.series if one.more.get("panel", 0) == k]
        _panel(panels[-1], replace(chart, y=axis), own, width=width, last=k == len(chart.below))
    if modes := chart.more.get("modes"):
        for k, axes in enumerate(panels):
            mark_modes(axes, np.asarray(modes), width=width, label=k == 0)
    key(panels[0], names_width(chart) - 0.05, NUMBERS * bool(chart.more.get("modes")))
    return panels


def _panel(axes: Axes, chart: Chart, series: Sequence[Series], *, width: float, last: bool) -> None:
    bare, rows = bool(chart.more.get("bare")), bool(chart.y.names)
    tidy(axes, x=chart.x.title if last else "", y=chart.y.title, grid="" if bare else "x" if rows else "both")
    axes.use_sticky_edges = False
    _scaled(axes, chart.x, upright=False)
    _scaled(axes, chart.y, upright=True)
    for k, one in enumerate(series):
        on = _behind(axes, one) if one.more.get("right") else axes
        draw_series(on, one, chart, 2.0 + k / 10)
    for at in chart.more.get("lines", ()):
        axes.axvline(at, color=MUTED, linewidth=0.9, linestyle=(0, (2, 2)), zorder=1.3)
    if chart.more.get("zero"):
        axes.axvline(0, color=MUTED, linewidth=0.9, zorder=1.9)
    _named(axes, chart, width)
    if chart.x.zero and axes.get_xlim()[0] < 0 and not chart.more.get("zero"):
        axes.set_xlim(left=0)
    if chart.y.zero:
        axes.set_ylim(bottom=0)
    if not last:
        axes.tick_params(labelbottom=False)
    if bare:
        axes.set_axis_off()


def _behind(axes: Axes, series: Series) -> Axes:
    """Return an axis on the right-hand side for a curve behind the marks."""
    twin = axes.twinx()
    tidy(twin, y=series.name, grid="")
    twin.set_yscale("log")
    for side in ("left", "bottom"):
        twin.spines[side].set_visible(False)
    twin.tick_params(labelcolor=MUTED)
    twin.yaxis.label.set_color(MUTED)
    axes.set_zorder(twin.get_zorder() + 1)
    axes.patch.set_alpha(0.0)
    return twin


def _scaled(axes: Axes, axis: Axis, *, upright: bool) -> None:
    """Give an axis its scale, ends and ticks."""
    own = axes.yaxis if upright else axes.xaxis
    if axis.log:
        (axes.set_yscale if upright else axes.set_xscale)("log")
    if axis.log and not upright:
        own.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        own.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        own.set_minor_formatter(NullFormatter())
    if not axis.log and not axis.names:
        own.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.10g}".replace("-", "−")))
    if axis.range is not None:
        (axes.set_ylim if upright else axes.set_xlim)(*axis.range)
    elif not axis.names:
        (axes.set_ymargin if upright else axes.set_xmargin)(0.08)
    if axis.ticks:
        own.set_ticks(axis.ticks)


def _named(axes: Axes, chart: Chart, width: float) -> None:
    """Write the names of rows and columns, and what stands beside the rows."""
    if names := chart.y.names:
        room = 72 * min(NAMES, names_width(chart))
        axes.set_yticks(range(len(names)), [shortened(name, room, SMALL) for name in names])
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
    for row, text in enumerate(chart.more.get("notes", ())):
        axes.annotate(
            text, (1, row), xycoords=("axes fraction", "data"), xytext=(10, 0), textcoords="offset points",
            va="center", fontsize=SMALL, color=INK, annotation_clip=False,
        )  # fmt: skip
    if names := chart.x.names:
        turned = max(text_width(name, SMALL) for name in names) + 6 > 72 * width / len(names)
        axes.set_xticks(range(len(names)), list(names), rotation=90 if turned else 0)
        axes.set_xlim(-0.5, len(names) - 0.5)
        axes.tick_params(axis="x", length=0)
    if "cell" in chart.more:
        for spine in axes.spines.values():
            spine.set_visible(False)


def names_width(chart: Chart) -> float:
    """Return the width that names or numbers of the upright axis take, with its title [in]."""
    title = 0.3 * bool(chart.y.title)
    if not chart.y.names:
        return 0.0 if chart.more.get("bare") else 0.5 + title
    return min(NAMES, max(text_width(name, SMALL) for name in chart.y.names) / 72) + 0.15 + title


def _notes_width(chart: Chart) -> float:
    beside = any(one.more.get("right") for one in chart.series)
    notes = max((text_width(text, SMALL) for text in chart.more.get("notes", ())), default=0.0) / 72
    return notes + 0.2 * bool(notes) + 0.75 * beside


def _side(chart: Chart) -> float:
    return min(CELL[1], max(CELL[0], 8.5 / max(len(chart.x.names), len(chart.y.names))))


def _body(chart: Chart, width: float) -> float:
    """Return the width of the body of a chart in a column of some width: that of a matrix has square cells [in]."""
    return min(width, _side(chart) * len(chart.x.names)) if "cell" in chart.more else width


def chart_height(chart: Chart, width: float) -> float:
    """Return the height of the body of a chart with the panels beneath it [in]."""
    if "equal" in chart.more:
        return float(chart.more["equal"]) * width
    if "cell" in chart.more:
        return _body(chart, width) / len(chart.x.names) * len(chart.y.names)
    if chart.y.names:
        return max(0.8, float(chart.more.get("row", 26)) / 86 * len(chart.y.names))
    return TALL * chart.height / 300 + len(chart.below) * (BELOW + GAP) - 1.2 * bool(chart.below)


def above(chart: Chart, width: float) -> float:
    """Return the height of the key and of the numbers of modes over a body of some width [in]."""
    shown = [one for one in chart.series if not one.more.get("right")]
    names = list(dict.fromkeys(one.name for one in shown if one.name and not one.more.get("unnamed")))
    lines = key_lines(names, width + names_width(chart)) if names else 0
    return KEY * lines + NUMBERS * bool(chart.more.get("modes")) + 0.05


def under(chart: Chart) -> float:
    """Return the height of the lower axis with its names and title [in]."""
    if chart.more.get("bare"):
        return 0.1
    names = max((text_width(name, SMALL) for name in chart.x.names), default=0.0) / 72
    return UNDER - 0.2 * (not chart.x.title) + max(0.0, names - 0.2)
