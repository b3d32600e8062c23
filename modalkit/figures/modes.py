"""Modes marked on a frequency axis, without labels that collide."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from acquisition.arrays import FloatArray
from modalkit.figures.style import BLUE, SMALL, grouped, numbers

ROOM = (0.17, 0.25)
"""Width that a number of one digit and of two takes [in]."""


def mark_modes(axes: Axes, frequency: FloatArray, *, width: float, label: bool = True) -> None:
    """Draw a thin line at every mode and number it over the panel.

    Parameters
    ----------
    axes : Axes
        A panel whose horizontal limits are set.
    frequency : (n_modes,) array
        Natural frequencies [Hz].
    width : float
        Width of the panel [in].
    label : bool
        Whether to write the numbers.
    """
    low, high = axes.get_xlim()
    order = np.argsort(frequency)
    for value in frequency:
        axes.axvline(value, color=BLUE, linewidth=0.8, alpha=0.45, zorder=1.5)
    if not label:
        return
    places = frequency[order]
    needed = ROOM[len(frequency) > 9]
    for group in grouped(places.tolist(), needed * (high - low) / width):
        middle = float(np.mean(places[group]))
        axes.annotate(
            numbers([int(order[i]) for i in group]),
            (middle, 1),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=SMALL,
            color=BLUE,
        )
