"""FRAC by point, before and after, as bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from acquisition.arrays import FloatArray
from modalkit.figures.style import (
    BLUE,
    FAINT,
    MARGIN,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)


def frac_figure(title: str, note: str, points: Sequence[str], bars: Mapping[str, FloatArray]) -> Figure:
    """Draw FRAC of every point for two models.

    Parameters
    ----------
    title, note : str
        What the figure states, and what stands behind it.
    points : sequence of str
        Names of the points.
    bars : mapping of str to (n_points,) array
        FRAC of the model before and of the one after, by what the key calls them [-].

    Returns
    -------
    Figure
    """
    top = caption_height(title, note) + 0.5
    figure = new_figure(top + 2.9 + 0.75)
    caption(figure, title, note)
    axes = place(figure, MARGIN + 0.6, top, WIDTH - 2 * MARGIN - 0.6, 2.9, name="FRAC")
    tidy(axes, x="point", y="FRAC [-]", grid="y")
    at = np.arange(len(points))
    wide = 0.8 / len(bars)
    for i, (name, values) in enumerate(bars.items()):
        colour = BLUE if i == len(bars) - 1 else FAINT
        places = at + (i - (len(bars) - 1) / 2) * wide
        axes.bar(places, values, 0.92 * wide, color=colour, label=name)
    axes.set_xticks(at, points)
    axes.tick_params(axis="x", length=0)
    axes.set_ylim(0, 1.0)
    axes.set_xlim(-0.6, len(points) - 0.4)
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=len(bars), frameon=False, fontsize=SMALL,
        handlelength=1.2, borderpad=0.0, borderaxespad=0.0,
    )  # fmt: skip
    return figure
