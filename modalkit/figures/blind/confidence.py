"""Whether the confidence of a diagnosis is justified: what it answers against how often it is right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.blind.scoring.abstention import ANSWERED, BOTH, KNOWN, RIGHT, asked_of, curve
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.table import Rate
from modalkit.figures.style import (
    BLUE,
    MARGIN,
    MUTED,
    ORANGE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    key,
    new_figure,
    place,
    tidy,
)

SIDE = 4.6
"""Side of a panel [in]."""


@dataclass(frozen=True, eq=False)
class Curve:
    """What is answered against how often it is right, of a group of trials.

    Parameters
    ----------
    points : pandas.DataFrame
        As :func:`modalkit.blind.scoring.abstention.curve` returns them.
    answered, right : Rate
        The same at the diagnosis's own rule.
    """

    points: pd.DataFrame
    answered: Rate
    right: Rate


def curve_of(score: Score, group: str) -> Curve:
    """Return the curve of one of the groups of :mod:`modalkit.blind.scoring.abstention`."""
    trials = asked_of(score.trials, group)
    points = curve(trials["confidence"].to_numpy(float), trials["first"].to_numpy(float))
    return Curve(points, score.rates[ANSWERED, group], score.rates[RIGHT, group])


def abstention_figure(score: Score) -> Figure:
    """Draw what is answered against how often it is right, without and with effects that cannot be known.

    Parameters
    ----------
    score : Score
        Of a blind run.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If nothing was answered at any probability.
    """
    known, both = curve_of(score, KNOWN), curve_of(score, BOTH)
    if known.points.empty:
        raise InputError(
            "no trial of the blind run was answered at any probability; there is no curve to draw"
        )
    answered = f"{100 * known.answered.rate:.0f} % of the trials"
    title = f"It commits in {answered}, and is right in {_percent(known.right.rate)} of those"
    note = (
        f"Rule: one set holds 95 %, or none; {known.right.count} of {known.right.total} right, of "
        f"{known.answered.total} trials. Along "
        "the curve the least probability for an answer falls; bands are 95 % intervals."
    )
    top = caption_height(title, note) + 0.4
    figure = new_figure(top + SIDE + 0.7)
    caption(figure, title, note)
    axes = place(figure, MARGIN + 0.75, top, WIDTH - 2 * MARGIN - 0.95, SIDE, name="abstention")
    tidy(axes, x="answered [% of the trials]", y="right [% of those answered]")
    lowest = min(_curve(axes, known, BLUE, "effects of the library, and none", 1.0), 100.0)
    if len(both.points) and both.answered.total > known.answered.total:
        lowest = min(lowest, _curve(axes, both, ORANGE, "with effects it cannot know", 0.6))
    axes.set_xlim(0, 100)
    axes.set_ylim(max(0.0, 10 * np.floor(lowest / 10) - 5), 101)
    key(axes, 0.75)
    return figure


def _percent(value: float) -> str:
    return (
        "none"
        if not np.isfinite(value)
        else f"{100 * value:.1f} %"
        if 0.99 < value < 1
        else f"{100 * value:.0f} %"
    )


def _curve(axes: Axes, drawn: Curve, colour: str, words: str, strength: float) -> float:
    """Draw one curve with its band and its rule, and return its lowest point [%]."""
    across, right, low, high = (
        100 * drawn.points[name].to_numpy(float) for name in ("answered", "right", "low", "high")
    )
    axes.fill_between(across, low, high, color=colour, alpha=0.14 * strength, linewidth=0, zorder=1.5)
    axes.plot(across, right, color=colour, linewidth=2.0, label=words, zorder=3)
    for t in (0.5, 0.9, 0.99):
        reached = np.flatnonzero(drawn.points["threshold"].to_numpy(float) >= t)
        if len(reached) and strength == 1.0:
            axes.plot(
                across[reached[-1]],
                right[reached[-1]],
                "o",
                ms=5,
                color="white",
                mec=colour,
                mew=1.5,
                zorder=4,
            )
            axes.annotate(
                f"p ≥ {t:g}",
                (across[reached[-1]], right[reached[-1]]),
                xytext=(-4, -16),
                textcoords="offset points",
                fontsize=SMALL,
                color=MUTED,
                ha="right",
            )
    rule = drawn.right
    if np.isfinite(rule.rate):
        x, y = 100 * drawn.answered.rate, 100 * rule.rate
        axes.vlines(x, 100 * rule.low, 100 * rule.high, color=colour, linewidth=1.6, zorder=4)
        axes.plot(
            x,
            y,
            "D",
            ms=9,
            color=colour,
            mec="white",
            mew=1.0,
            zorder=5,
            clip_on=False,
            label="its own rule" if strength == 1.0 else None,
        )
    shown = right[across > 5] if (across > 5).any() else right
    return float(min(shown.min(), 100 * rule.low if np.isfinite(rule.rate) else 100.0))
