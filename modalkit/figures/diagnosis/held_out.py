"""Does it hold: the gap on modes that were held out, for the answer and for its rivals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from modalkit.figures.style import BLUE, FAINT, GRID, INK, MUTED, SMALL, TEXT, shortened, tidy
from modalkit.output.words import METRICS
from modalkit.views.charts.causes import rivals
from updating import Diagnosis


def draw_held_out(axes: Axes, diagnosis: Diagnosis, *, room: float, fitted: bool = False) -> None:
    """Draw one dot per explanation on a logarithmic axis, and the noise floor as a band.

    Parameters
    ----------
    axes : Axes
        The panel.
    diagnosis : Diagnosis
        The answer.
    room : float
        Width left of the panel for the names [in].
    fitted : bool
        Whether the gap on the fitted data is drawn too, as a ring.
    """
    rows = rivals(diagnosis)
    floor = diagnosis.shrink.floor
    values = np.array([max(value, 1e-4) for _, value, _ in rows])
    inside = max(diagnosis.shrink.after, 1e-4) if fitted and diagnosis.ranking else None
    everything = np.append(values, [max(floor, 1e-4)] + ([] if inside is None else [inside]))
    low, high = everything.min() / 2.0, everything.max() * 2.6
    metric = diagnosis.shrink.metric
    whole = 100.0 if metric == "combined" else 1.0
    unit = "standard deviations" if metric == "combined" else "%"
    tidy(axes, x=f"{METRICS[metric]} gap on modes held out in turn, r.m.s. [{unit}]", grid="x")
    axes.set_xscale("log")
    axes.set_xlim(low, high)
    axes.axvspan(low, max(floor, low), color=GRID, zorder=0.5, linewidth=0)
    axes.hlines(range(len(rows)), low, values, color=FAINT, linewidth=1.2, linestyle=(0, (1, 2)))
    for i, (_, value, best) in enumerate(rows):
        _dot(axes, values[i], i, diagnosis.shrink.size(value), best=best)
    if inside is not None:
        _ring(axes, inside, len(rows) - 1, diagnosis.shrink.size(inside))
    _names(axes, [(label, best) for label, _, best in rows], room)
    wide = np.log(max(floor, low) / low) > 0.25 * np.log(high / low)
    axes.annotate(
        f"noise {diagnosis.shrink.size(floor)}",
        (max(floor, low), -0.62),
        xytext=(-5 if wide else 5, 0),
        textcoords="offset points",
        ha="right" if wide else "left",
        va="center",
        fontsize=SMALL,
        color=MUTED,
    )
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0) if high / low < 300 else (1.0,)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value / whole:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _dot(axes: Axes, value: float, row: int, size: str, *, best: bool) -> None:
    """Mark what one explanation leaves, and write it beside."""
    colour = BLUE if best else FAINT
    axes.scatter(
        [value], [row], s=95 if best else 70, color=colour, edgecolor="white", zorder=4, clip_on=False
    )
    axes.annotate(
        size, (value, row), xytext=(9, 0), textcoords="offset points", va="center", fontsize=TEXT, color=INK,
        fontweight="bold" if best else "normal",
    )  # fmt: skip


def _names(axes: Axes, rows: Sequence[tuple[str, bool]], room: float) -> None:
    """Write the explanations left of the panel, those of the answer bold."""
    names = [shortened(label, 72 * room, TEXT, weight="bold") for label, _ in rows]
    axes.set_yticks(range(len(rows)), names, fontsize=TEXT)
    for label, (_, best) in zip(axes.get_yticklabels(), rows, strict=True):
        label.set_fontweight("bold" if best else "normal")
    axes.set_ylim(len(rows) - 0.45, -0.95)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def _ring(axes: Axes, value: float, row: int, size: str) -> None:
    """Mark the gap on the fitted data, and say below what it is."""
    axes.scatter(
        [value], [row], s=70, facecolor="white", edgecolor=BLUE, linewidth=1.6, zorder=5, clip_on=False
    )
    axes.annotate(
        f"{size} fitted",
        (value, row),
        xytext=(0, -13),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=SMALL,
        color=MUTED,
        annotation_clip=False,
    )
