"""The score of a blind run: what was hidden, what was answered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from acquisition import InputError
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    GRID,
    INK,
    MARGIN,
    MUTED,
    PROBABILITY,
    SMALL,
    TEXT,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    shortened,
    text_width,
    tidy,
)

LAST = ("class with it", "class without it", "named nothing", "unknown", "none", "failed")
"""Answers that name no single effect, in the order of their columns."""


def blind_figure(
    confusion: pd.DataFrame, rates: pd.DataFrame | None = None, *, withheld: Sequence[str] = ()
) -> Figure:
    """Draw the confusion matrix of a blind run, and its rates with their intervals.

    Parameters
    ----------
    confusion : DataFrame
        Counts, hidden effect (rows) against answer (columns).
    rates : DataFrame, optional
        ``count``, ``total``, ``rate``, ``low95``, ``high95`` by question; questions without trials are left out.
    withheld : sequence of str
        Rows whose effect is not in the library, so that ``unknown`` is the right answer.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no counts.
    """
    if confusion.size == 0 or not confusion.to_numpy().sum():
        raise InputError("the blind run has no trials to draw; run at least one")
    table = _ordered(confusion)
    right = _right(table, withheld)
    counts = table.to_numpy(dtype=float)
    title = f"{counts[right].sum():.0f} of {counts.sum():.0f} hidden causes answered truly"
    note = "an answer is true if it names the cause, gives a class that holds it, or says that there is none"
    top = caption_height(title, note) + 0.12
    asked = None if rates is None else rates[rates["total"] > 0]
    names = [str(name).replace("_", " ") for name in table.columns]
    above = max(text_width(name, SMALL) for name in names) / 72 + 0.15
    cell = min(0.5, 8.2 / len(names))
    tall = cell * len(table)
    upper = top + above + 0.3
    low = 0.0 if asked is None or asked.empty else 0.30 * len(asked)
    figure = new_figure(upper + tall + (0.35 if not low else 0.95 + low + 0.65))
    caption(figure, title, note)
    left = MARGIN + 0.35 + max(text_width(str(name), SMALL) for name in table.index) / 72
    _cells(place(figure, left, upper, cell * len(names), tall, name="confusion"), table, names, right)
    if low:
        heading(figure, MARGIN, upper + tall + 0.75, "Rates, with 95 % intervals")
        assert asked is not None
        _rates(place(figure, 4.6, upper + tall + 0.95, WIDTH - 4.6 - 1.9, low, name="rates"), asked)
    return figure


def _ordered(confusion: pd.DataFrame) -> pd.DataFrame:
    """Put every effect's own name in the order of the rows, then other names, then answers without a name."""
    rows = sorted(confusion.index, key=lambda name: (name == "none", str(name)))
    named = [c for c in confusion.columns if c not in LAST]
    columns = sorted(named, key=lambda c: (rows.index(c) if c in rows else len(rows), str(c)))
    return confusion.loc[rows, [*columns, *[c for c in LAST if c in confusion.columns]]]


def _right(table: pd.DataFrame, withheld: Sequence[str]) -> np.ndarray:
    """Return which cells are true answers."""
    right = np.zeros(table.shape, dtype=bool)
    for i, hidden in enumerate(table.index):
        for j, said in enumerate(table.columns):
            own = said == hidden or (said == "class with it" and hidden != "none")
            own = own and hidden not in withheld
            right[i, j] = own or (hidden in withheld and said == "unknown")
    return right


def _cells(axes: Axes, table: pd.DataFrame, names: list[str], right: np.ndarray) -> None:
    counts = table.to_numpy(dtype=float)
    share = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    axes.pcolormesh(share, cmap=PROBABILITY, vmin=0, vmax=1, edgecolors="white", linewidth=1.2)
    axes.invert_yaxis()
    for (i, j), count in np.ndenumerate(counts):
        if count:
            colour = "white" if share[i, j] > 0.5 else INK
            axes.text(j + 0.5, i + 0.5, f"{count:.0f}", fontsize=TEXT, color=colour, ha="center", va="center")
        if right[i, j]:
            frame = Rectangle(
                (j + 0.05, i + 0.05), 0.9, 0.9, fill=False, edgecolor=GREEN, linewidth=1.6, zorder=4
            )
            axes.add_patch(frame)
    axes.set_xticks(np.arange(len(names)) + 0.5, names, rotation=90, fontsize=SMALL, color=INK)
    axes.xaxis.tick_top()
    axes.set_yticks(
        np.arange(len(table)) + 0.5,
        [str(n).replace("_", " ") for n in table.index],
        fontsize=SMALL,
        color=INK,
    )
    axes.tick_params(length=0)
    axes.set_ylabel("hidden", fontsize=TEXT, color=MUTED)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.text(
        1.01, 0.0, "green: a true answer", transform=axes.transAxes, fontsize=SMALL, color=GREEN, va="bottom"
    )


def _rates(axes: Axes, rates: pd.DataFrame) -> None:
    tidy(axes, x="share of the trials asked [%]", grid="x")
    rows = np.arange(len(rates))
    rate, low, high = (100 * rates[name].to_numpy(float) for name in ("rate", "low95", "high95"))
    axes.barh(rows, 100, height=0.5, color=GRID, alpha=0.35)
    axes.hlines(rows, low, high, color=FAINT, linewidth=3.0, zorder=2)
    axes.scatter(rate, rows, s=48, color=BLUE, edgecolor="white", zorder=3, clip_on=False)
    for row, (count, total) in enumerate(zip(rates["count"], rates["total"], strict=True)):
        text = f"{rate[row]:.0f} %   {count} of {total}"
        axes.annotate(text, (1, row), xycoords=("axes fraction", "data"), xytext=(10, 0), textcoords="offset points",
                      va="center", fontsize=TEXT, color=INK, annotation_clip=False)  # fmt: skip
    axes.set_yticks(rows, [shortened(str(name), 72 * 4.1, SMALL) for name in rates.index], fontsize=SMALL)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
