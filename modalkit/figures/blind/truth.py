"""How strong: stated against true, parameter by parameter."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from modalkit.figures.style import (
    BLUE,
    INK,
    MUTED,
    ORANGE,
    PALE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)

SPREADS = (0.1, 0.25, 0.5, 1.0)
"""Ranges of relative errors, of which the least is taken that holds nearly all; the rest is drawn at the edge [-]."""


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
