"""How often a blind run was right, with intervals."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.blind.scoring.rates import TRUE_OF_SHOWN, effect_group, headline
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.table import Rate
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


def rates_figure(score: Score) -> Figure:
    """Draw the first numbers of a score, and how often it is right effect by effect.

    Parameters
    ----------
    score : Score
        Of a blind run; effects of which nothing was asked are left out, and so are pairs, of which there are many.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If nothing was asked at all.
    """
    asked = headline(score.rates)
    if not asked:
        raise InputError("the blind run asks nothing that can be drawn; run more trials")
    some = _by_effect(score)
    name, first = next(iter(asked.items()))
    title = f"{name[0].upper()}{name[1:]} in {_count(first)} blind trials"
    note = (
        "Bars are 95 % intervals. Effects fainter than three standard deviations are not asked for. "
        "Effect by effect, an answer is right that names it, holds it in a class, or is unknown where it "
        "cannot be known."
    )
    top = caption_height(title, note) + 0.1
    left = MARGIN + 0.15 + min(4.3, max(text_width(name, SMALL) for name in asked) / 72)
    wide, upper = WIDTH - left - 1.9, ROW * len(asked)
    lower = SLIM * len(some)
    figure = new_figure(top + upper + 0.75 + (lower + 0.95 if len(some) else 0.0))
    caption(figure, title, note)
    names = [shortened(name, 72 * 4.3, SMALL) for name in asked]
    axes = place(figure, left, top, wide, upper, name="rates")
    _bars(axes, list(asked.values()), names, [BLUE] * len(asked))
    if some:
        down = top + upper + 1.05
        heading(figure, MARGIN, down - 0.12, "Effect by effect")
        axes = place(figure, left, down, wide, lower, name="effects")
        labels = [effect.replace("_", " ") for _, effect, _ in some]
        _bars(axes, [row for _, _, row in some], labels, [COLOURS[sort] for sort, _, _ in some])
        _key(axes, {sort for sort, _, _ in some})
    return figure


def _by_effect(score: Score) -> list[tuple[str, str, Rate]]:
    """Return sort, effect and how often right, the best first, of what was asked of single effects."""
    pairs = score.trials[["sort", "effect"]].drop_duplicates().itertuples(index=False)
    found = [
        (sort, effect, score.rates[TRUE_OF_SHOWN, effect_group(sort, effect)])
        for sort, effect in pairs
        if " + " not in effect
    ]
    return sorted((one for one in found if one[2].total), key=lambda one: (one[0], -one[2].rate, one[1]))


def _count(row: Rate) -> str:
    return f"{row.count:.0f} of {row.total}"


def _bars(axes: Axes, table: Sequence[Rate], names: list[str], colours: list[str]) -> None:
    tidy(axes, x="share of the trials asked [%]", grid="x")
    rows = np.arange(len(table))
    rate, low, high = 100 * np.array([(row.rate, row.low, row.high) for row in table]).T
    axes.barh(rows, 100, height=0.62, color=PALE, zorder=0.5)
    axes.barh(rows, high - low, left=low, height=0.62, color=BAND, zorder=1)
    axes.scatter(rate, rows, s=42, color=colours, edgecolor="white", linewidth=0.8, zorder=3, clip_on=False)
    for k, row in enumerate(table):
        for text, across, ink in ((f"{percent(row.rate)} %", 12, INK), (_count(row), 52, MUTED)):
            axes.annotate(
                text,
                (1, k),
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


def _key(axes: Axes, sorts: Collection[str]) -> None:
    """State what the colours of the dots are."""
    words = {
        "effect": "in the library",
        "none": "none hidden",
        "left out": "left out",
        "outside": "not in the library",
    }
    shown = [sort for sort in words if sort in sorts]
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
