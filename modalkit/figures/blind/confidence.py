"""Whether a diagnosis knows when it is right: abstention, reliability, and what it cannot know."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.figures.dumbbell import key
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    head,
    new_figure,
    place,
    tidy,
)

SIDE = 4.6
"""Side of a panel [in]."""

Curve = tuple[pd.DataFrame, Mapping[str, Any]]


def abstention_figure(known: Curve, outside: Curve | None = None) -> Figure:
    """Draw what is answered against how often it is right.

    Parameters
    ----------
    known : (DataFrame, mapping)
        Curve (``threshold``, ``answered``, ``right``, ``low95``, ``high95``) of effects of the library and none,
        and the diagnosis's own rule (``answered``, ``rate``, ``low95``, ``high95``, ``count``, ``total``, ``of``).
    outside : (DataFrame, mapping), optional
        The same with effects among them that cannot be known.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If nothing was answered at any probability.
    """
    curve, rule = known
    if curve.empty:
        raise InputError(
            "no trial of the blind run was answered at any probability; there is no curve to draw"
        )
    answered = f"{100 * rule['answered']:.0f} % of the trials"
    title = f"It commits in {answered}, and is right in {_percent(rule['rate'])} of those"
    note = (
        f"Rule: one set holds 95 %, or none; {rule['count']} of {rule['total']} right, of {rule['of']} trials. Along "
        "the curve the probability falls from which one answers; bands are 95 % intervals."
    )
    top = caption_height(title, note) + 0.4
    figure = new_figure(top + SIDE + 0.7)
    caption(figure, title, note)
    axes = place(figure, MARGIN + 0.75, top, WIDTH - 2 * MARGIN - 0.95, SIDE, name="abstention")
    tidy(axes, x="answered [% of the trials]", y="right [% of those answered]")
    lowest = min(_curve(axes, curve, rule, BLUE, "effects of the library, and none", 1.0), 100.0)
    if outside is not None and len(outside[0]) and outside[1]["of"] > rule["of"]:
        lowest = min(lowest, _curve(axes, *outside, ORANGE, "with effects it cannot know", 0.6))
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


def _curve(
    axes: Axes, curve: pd.DataFrame, rule: Mapping[str, Any], colour: str, words: str, strength: float
) -> float:
    """Draw one curve with its band and its rule, and return its lowest point [%]."""
    across, right = 100 * curve["answered"].to_numpy(float), 100 * curve["right"].to_numpy(float)
    low, high = 100 * curve["low95"].to_numpy(float), 100 * curve["high95"].to_numpy(float)
    axes.fill_between(across, low, high, color=colour, alpha=0.14 * strength, linewidth=0, zorder=1.5)
    axes.plot(across, right, color=colour, linewidth=2.0, label=words, zorder=3)
    for t in (0.5, 0.9, 0.99):
        reached = np.flatnonzero(curve["threshold"].to_numpy(float) >= t)
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
    if np.isfinite(rule["rate"]):
        x, y = 100 * rule["answered"], 100 * rule["rate"]
        axes.vlines(x, 100 * rule["low95"], 100 * rule["high95"], color=colour, linewidth=1.6, zorder=4)
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
    return float(min(shown.min(), 100 * rule["low95"] if np.isfinite(rule["rate"]) else 100.0))


def reliability_figure(
    reliability: pd.DataFrame, calibration: pd.DataFrame, roc: pd.DataFrame, area: Mapping[str, Any]
) -> Figure:
    """Draw how often a probability comes true, and how well the fit tells what cannot be known.

    Parameters
    ----------
    reliability : pandas.DataFrame
        ``stated``, ``rate``, ``low95``, ``high95``, ``count``, ``total`` by bin.
    calibration : pandas.DataFrame
        ``trials``, ``measure``, ``value``, ``low95``, ``high95``.
    roc : pandas.DataFrame
        ``false`` and ``found`` [-]; may be empty.
    area : mapping
        ``value``, ``low95``, ``high95``, ``total`` of the area under it.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no probabilities.
    """
    if reliability.empty:
        raise InputError(
            "the blind run has no probabilities to compare with the truth; hide effects of the library"
        )
    title = _calibrated(calibration)
    note = (
        "Left: effects of the library that the data show, and none. Right: the worse the best row fits, the more "
        "unknown."
    )
    top = caption_height(title, note) + 0.45
    figure = new_figure(top + SIDE + 0.7)
    caption(figure, title, note)
    _reliability(place(figure, MARGIN + 0.75, top, SIDE, SIDE, name="reliability"), reliability)
    _roc(place(figure, WIDTH - MARGIN - SIDE - 0.1, top, SIDE, SIDE, name="roc"), roc, area)
    return figure


def _calibrated(calibration: pd.DataFrame) -> str:
    some = calibration[(calibration["measure"] == "expected calibration error") & (calibration["total"] > 0)]
    if some.empty:
        return "Probabilities against what came true"
    row = some.iloc[0]
    low, high = 100 * row["low95"], 100 * row["high95"]
    return (
        f"Probabilities are off by {100 * row['value']:.1f} points of % in the mean ({low:.1f} to {high:.1f})"
    )


def _reliability(axes: Axes, table: pd.DataFrame) -> None:
    tidy(axes, x="probability stated for the first set [%]", y="came true [%]")
    head(axes, "Reliability")
    axes.plot([0, 100], [0, 100], color=FAINT, linewidth=1.2, zorder=1.5)
    stated, rate = 100 * table["stated"].to_numpy(float), 100 * table["rate"].to_numpy(float)
    low, high = 100 * table["low95"].to_numpy(float), 100 * table["high95"].to_numpy(float)
    axes.vlines(stated, low, high, color=BLUE, linewidth=2.0, alpha=0.45, zorder=2)
    size = 25 + 160 * np.sqrt(table["total"] / table["total"].max())
    axes.scatter(stated, rate, s=size, color=BLUE, edgecolor="white", linewidth=1.0, zorder=3, clip_on=False)
    axes.set_xlim(0, 101)
    axes.set_ylim(0, 101)
    axes.text(99, 3, "dots as large as their bins", fontsize=SMALL, color=MUTED, ha="right")


def _roc(axes: Axes, roc: pd.DataFrame, area: Mapping[str, Any]) -> None:
    tidy(axes, x="known effects called unknown [%]", y="unknowable ones found [%]")
    head(axes, "Unknown told from known by the fit")
    axes.plot([0, 100], [0, 100], color=FAINT, linewidth=1.2, zorder=1.5)
    axes.set_xlim(0, 101)
    axes.set_ylim(0, 101)
    value = float(area["value"])
    if roc.empty or not np.isfinite(value):
        axes.text(50, 50, "nothing to tell apart in this run", fontsize=SMALL, color=MUTED, ha="center")
        return
    across, up = (100 * np.concatenate([[0.0], roc[name].to_numpy(float)]) for name in ("false", "found"))
    axes.step(across, up, where="post", color=BLUE, linewidth=2.0, zorder=3)
    text = f"area {value:.2f} ({area['low95']:.2f} to {area['high95']:.2f})"
    axes.text(99, 3, text, fontsize=SMALL, color=INK, ha="right")
