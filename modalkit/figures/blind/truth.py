"""How strong, where and how far it closes: stated against true."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from acquisition.arrays import FloatArray
from modalkit.blind.scoring.closing import comparable
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    PALE,
    SERIES,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    head,
    new_figure,
    place,
    tidy,
)

SPREADS = (0.1, 0.25, 0.5, 1.0)
"""Ranges of relative errors, of which the least is taken that holds nearly all; the rest is drawn at the edge [-]."""

SIDE = 4.6
"""Side of a panel [in]."""


def severity_figure(severity: pd.DataFrame) -> Figure:
    """Draw the error of every parameter with its interval, parameter by parameter.

    Parameters
    ----------
    severity : pandas.DataFrame
        ``parameter``, ``true``, ``value``, ``low95``, ``high95`` [SI], ``error`` [-], ``covered``.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no parameters.
    """
    some = severity[severity["error"].notna()]
    if some.empty:
        raise InputError("no hidden effect with a parameter was named; there is no severity to draw")
    names = sorted(some["parameter"].unique())
    spread = _spread(some)
    covered = some["covered"].dropna().astype(bool)
    title = f"{covered.sum()} of {len(covered)} parameters lie inside their 95 % intervals"
    note = (
        f"Error relative to the true value, median {100 * some['error'].abs().median():.1f} %; one line is one trial, "
        "orange where the interval misses the truth."
    )
    top = caption_height(title, note) + 0.15
    heights = [0.16 + min(0.55, 0.022 * int((some["parameter"] == name).sum())) for name in names]
    figure = new_figure(top + sum(heights) + 0.65)
    caption(figure, title, note)
    axes = place(figure, 3.1, top, WIDTH - 3.1 - 1.3, sum(heights), name="severity")
    tidy(axes, x="stated over true, minus 1 [%]", grid="x")
    axes.axvline(0, color=MUTED, linewidth=0.9, zorder=1.2)
    base = np.concatenate([[0.0], np.cumsum(heights)])
    for i, name in enumerate(names):
        if i % 2:
            axes.axhspan(base[i], base[i + 1], color=PALE, alpha=0.6, linewidth=0, zorder=0.4)
        _trials(
            axes,
            some[some["parameter"] == name].sort_values("error"),
            base[i] + 0.07,
            base[i + 1] - 0.07,
            spread,
        )
    axes.set_yticks((base[:-1] + base[1:]) / 2, [name.replace("_", " ").replace(".", ": ") for name in names])
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(base[-1], 0)
    axes.set_xlim(-103 * spread, 103 * spread)
    axes.spines["left"].set_visible(False)
    return figure


def _spread(some: pd.DataFrame) -> float:
    """Return the least range that holds 19 of 20 errors and 9 of 10 ends of intervals."""
    ends = np.abs(some[["low95", "high95"]].to_numpy(float) / some[["true"]].to_numpy(float) - 1).ravel()
    ends = ends[np.isfinite(ends)]
    most = float(np.quantile(some["error"].abs(), 0.95))
    most = max(most, float(np.quantile(ends, 0.9))) if len(ends) else most
    return next((spread for spread in SPREADS if most <= spread), SPREADS[-1])


def _trials(axes: Axes, some: pd.DataFrame, begin: float, end: float, spread: float) -> None:
    down = np.linspace(begin, end, len(some) + 2)[1:-1]
    true = some["true"].to_numpy(float)
    edges = np.stack([some["low95"].to_numpy(float) / true, some["high95"].to_numpy(float) / true])
    low, high = (
        100 * (np.clip(edge, 1 - spread, 1 + spread) - 1) for edge in (edges.min(axis=0), edges.max(axis=0))
    )
    error = 100 * some["error"].to_numpy(float)
    missed = np.array(
        [value is not None and not (isinstance(value, float) or value) for value in some["covered"]]
    )
    colours = np.where(missed, ORANGE, BLUE)
    axes.hlines(down, low, high, color=colours, linewidth=1.0, alpha=0.55, zorder=2)
    beyond = np.abs(error) > 100 * spread
    axes.scatter(error[~beyond], down[~beyond], s=13, color=colours[~beyond], linewidth=0, zorder=3)
    edge = 100 * spread * np.sign(error[beyond])
    axes.scatter(edge, down[beyond], s=26, marker="D", color=colours[beyond], linewidth=0, zorder=3)
    covered = some["covered"].dropna().astype(bool)
    axes.annotate(
        f"{covered.sum()} of {len(covered)}",
        (1, (begin + end) / 2),
        xycoords=("axes fraction", "data"),
        xytext=(10, 0),
        textcoords="offset points",
        va="center",
        fontsize=SMALL,
        color=INK,
        annotation_clip=False,
    )


def closing_figure(closing: pd.DataFrame, places: pd.DataFrame) -> Figure:
    """Draw the stated shrinkage against the true one, and the errors of place.

    Parameters
    ----------
    closing : pandas.DataFrame
        ``statement``, ``low95``, ``high95``, ``true`` [%], ``metric``, ``true_metric``, ``held``.
    places : pandas.DataFrame
        ``nearest`` and ``first`` error [-], ``held``.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there is neither.
    """
    stated = comparable(closing)
    held = places[places["held"].astype(bool)]
    if stated.empty and held.empty:
        raise InputError(
            "no trial states how far its gap closes, or where the cause is; there is nothing to draw"
        )
    title = "How far the gap closes was not stated"
    if len(stated):
        distance = (stated["said"] - stated["true"]).abs()
        title = f"Stated and true shrinkage differ by {distance.mean():.1f} points of % in the mean"
    note = (
        "Left: share of the gap that closes; true: with the answer in the rig's own nominal body. Right: errors of "
        "place where the answer holds the effect, of the nearest of mirrored places and of the first one."
    )
    top = caption_height(title, note) + 0.45
    figure = new_figure(top + SIDE + 0.7)
    caption(figure, title, note)
    _closing(place(figure, MARGIN + 0.75, top, SIDE, SIDE, name="closing"), stated)
    _places(place(figure, WIDTH - MARGIN - SIDE - 0.1, top, SIDE, SIDE, name="places"), held)
    return figure


def _closing(axes: Axes, stated: pd.DataFrame) -> None:
    tidy(axes, x="true [%]", y="stated, on data held out [%]")
    head(axes, "How far the gap closes")
    low = 0.0
    if len(stated):
        low = float(min(stated["true"].quantile(0.02), stated["said"].quantile(0.02)))
        low = max(-100.0, min(0.0 if low < 60 else 50.0, 10 * np.floor(low / 10)))
    axes.plot([low, 100], [low, 100], color=FAINT, linewidth=1.2, zorder=1.5)
    right = stated["held"].astype(bool).to_numpy()
    many = min(1.0, 12.0 / np.sqrt(max(len(stated), 1)))
    for among, colour, words in (
        (right, BLUE, "answer holds the effect"),
        (~right, ORANGE, "answer is false"),
    ):
        some = stated[among]
        if some.empty:
            continue
        x = np.clip(some["true"].to_numpy(float), low, 100)
        bars = np.clip(some[["low95", "high95"]].to_numpy(float), low, 100)
        axes.vlines(x, bars[:, 0], bars[:, 1], color=colour, linewidth=1.0, alpha=0.35 * many, zorder=2)
        statement = np.clip(some["said"].to_numpy(float), low, 100)
        axes.scatter(
            x,
            statement,
            s=20,
            color=colour,
            alpha=max(0.4, many),
            linewidth=0,
            zorder=3,
            clip_on=False,
            label=words,
        )
    axes.set_xlim(low, 101)
    axes.set_ylim(low, 101)
    if len(stated):
        axes.legend(loc="lower right", frameon=False, fontsize=SMALL, labelcolor=INK)


def _places(axes: Axes, held: pd.DataFrame) -> None:
    tidy(axes, x="error of place [% of the span]", y="trials with less [%]")
    head(axes, "Where it sits")
    axes.set_ylim(0, 101)
    if held.empty:
        axes.text(
            0.5,
            0.5,
            "no place was stated",
            transform=axes.transAxes,
            fontsize=SMALL,
            color=MUTED,
            ha="center",
        )
        return
    axes.set_xscale("log")
    for i, (name, words) in enumerate((("nearest", "nearest of those offered"), ("first", "the first"))):
        error = np.sort(100 * held[name].to_numpy(float))
        axes.step(*_steps(np.maximum(error, 0.05)), where="post", color=SERIES[i], linewidth=2.0, label=words)
    axes.axvline(5, color=FAINT, linewidth=1.0, zorder=1.4)
    axes.set_xlim(0.1, 100)
    axes.set_xticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
    axes.legend(
        loc="upper left",
        frameon=False,
        fontsize=SMALL,
        labelcolor=INK,
        title=f"{len(held)} trials",
        alignment="left",
        title_fontsize=SMALL,
    )


def _steps(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distribution of sorted values, up to the right edge."""
    share = 100 * np.arange(1, len(values) + 1) / len(values)
    return np.concatenate([[1e-9], values, [1e9]]), np.concatenate([[0.0], share, [100.0]])
