"""How often a blind run was right, with intervals."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.blind.scoring.wording import percent
from modalkit.figures.style import (
    BAND,
    BLUE,
    GREEN,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    PALE,
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

ROW, SLIM = 0.32, 0.235
"""Height of a row of the first numbers, and of an effect [in]."""

COLOURS = {"effect": BLUE, "pair": BLUE, "none": GREEN, "outside": ORANGE, "left out": ORANGE}


def rates_figure(headline: pd.DataFrame, effects: pd.DataFrame) -> Figure:
    """Draw the first numbers of a score, and how often it is right effect by effect.

    Parameters
    ----------
    headline : pandas.DataFrame
        ``count``, ``total``, ``rate``, ``low95``, ``high95`` by number.
    effects : pandas.DataFrame
        ``sort``, ``effect``, ``visible``, ``rate``, ``low95``, ``high95``; effects of which nothing was asked are left
        out, and so are pairs, of which there are many.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If nothing was asked at all.
    """
    asked = headline[headline["total"] > 0]
    if asked.empty:
        raise InputError("the blind run asks nothing that can be drawn; run more trials")
    some = effects[effects["rate"].notna() & ~effects["effect"].str.contains(" + ", regex=False)]
    some = some.sort_values(["sort", "rate", "effect"], ascending=[True, False, True])
    first = asked.iloc[0]
    title = f"{asked.index[0][0].upper()}{asked.index[0][1:]} in {_count(first)} blind trials"
    note = (
        "Bars are 95 % intervals. Effects fainter than three standard deviations are not asked for. Effect by effect, "
        "an answer is right that names it, holds it in a class, or says unknown where it cannot be known."
    )
    top = caption_height(title, note) + 0.1
    left = MARGIN + 0.15 + min(4.3, max(text_width(str(n), SMALL) for n in asked.index) / 72)
    wide, upper = WIDTH - left - 1.9, ROW * len(asked)
    lower = SLIM * len(some)
    figure = new_figure(top + upper + 0.75 + (lower + 0.95 if len(some) else 0.0))
    caption(figure, title, note)
    names = [shortened(str(name), 72 * 4.3, SMALL) for name in asked.index]
    axes = place(figure, left, top, wide, upper, name="rates")
    _bars(axes, asked, names, [_count(row) for _, row in asked.iterrows()], [BLUE] * len(asked))
    if len(some):
        down = top + upper + 1.05
        heading(figure, MARGIN, down - 0.12, "Effect by effect")
        axes = place(figure, left, down, wide, lower, name="effects")
        labels = [str(name).replace("_", " ") for name in some["effect"]]
        totals = np.where(some["sort"] == "none", some["trials"], some["visible"])
        counts = [f"{rate * n:.0f} of {n}" for rate, n in zip(some["rate"], totals, strict=True)]
        _bars(axes, some, labels, counts, [COLOURS[sort] for sort in some["sort"]])
        _key(axes, some)
    return figure


def _count(row: pd.Series) -> str:
    return f"{row['count']:.0f} of {int(row['total'])}"


def _bars(axes: Axes, table: pd.DataFrame, names: list[str], counts: list[str], colours: list[str]) -> None:
    tidy(axes, x="share of the trials asked [%]", grid="x")
    rows = np.arange(len(table))
    rate, low, high = (100 * table[name].to_numpy(float) for name in ("rate", "low95", "high95"))
    axes.barh(rows, 100, height=0.62, color=PALE, zorder=0.5)
    axes.barh(rows, high - low, left=low, height=0.62, color=BAND, zorder=1)
    axes.scatter(rate, rows, s=42, color=colours, edgecolor="white", linewidth=0.8, zorder=3, clip_on=False)
    for row, count in enumerate(counts):
        for text, across, ink in ((f"{percent(rate[row] / 100)} %", 12, INK), (count, 52, MUTED)):
            axes.annotate(
                text,
                (1, row),
                xycoords=("axes fraction", "data"),
                xytext=(across, 0),
                textcoords="offset points",
                va="center",
                fontsize=SMALL,
                color=ink,
                annotation_clip=False,
            )
    axes.set_yticks(rows, names, fontsize=SMALL)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def _key(axes: Axes, some: pd.DataFrame) -> None:
    """Say what the colours of the dots are."""
    words = {
        "effect": "in the library",
        "none": "none hidden",
        "left out": "left out",
        "outside": "not in the library",
    }
    shown = [sort for sort in words if sort in set(some["sort"])]
    across = 1.0
    for sort in reversed(shown):
        axes.annotate(
            words[sort],
            (across, 1),
            xycoords="axes fraction",
            xytext=(0, 6),
            textcoords="offset points",
            ha="right",
            fontsize=SMALL,
            color=COLOURS[sort],
            annotation_clip=False,
        )
        across -= (text_width(words[sort], TEXT) / 72 + 0.15) / (axes.get_position().width * WIDTH)
