"""Letters of stability of a stabilisation chart: in what each pole agrees with one of the order below."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from identification.poles.stabilisation import StabilisationChart

MEANINGS = {
    "o": "new",
    "f": "frequency stable",
    "d": "frequency and damping stable",
    "v": "frequency and participation vector stable",
    "s": "all three stable",
}
"""Every letter with its meaning."""


def pole_stability(
    chart: StabilisationChart, *, frequency: float = 0.01, damping: float = 0.05, vector: float = 0.02
) -> NDArray[np.str_]:
    """Return the letter of every pole, (n_poles,).

    Parameters
    ----------
    chart : StabilisationChart
        The poles.
    frequency, damping : float
        Largest relative changes from the nearest pole of the order below [-].
    vector : float
        Largest 1 - MAC of the participation vectors [-]. One reference has no vector: ``d`` and ``s`` are then one,
        and ``v`` does not occur.
    """
    letters = np.full(len(chart.poles), "o", dtype="<U1")
    several = chart.participation.shape[1] > 1
    for level in range(1, len(chart.orders)):
        here, below = np.flatnonzero(chart.level == level), np.flatnonzero(chart.level == level - 1)
        if not len(here) or not len(below):
            continue
        apart = (
            np.abs(chart.frequency[here][:, None] - chart.frequency[below]) / chart.frequency[here][:, None]
        )
        nearest = below[apart.argmin(axis=1)]
        near = apart.min(axis=1) <= frequency
        change = np.abs(chart.damping[here] - chart.damping[nearest])
        damped = change <= damping * np.abs(chart.damping[here])
        mac = np.abs(np.sum(chart.participation[here].conj() * chart.participation[nearest], axis=1)) ** 2
        alike = (1 - mac <= vector) if several else damped
        letters[here] = np.select(
            [near & damped & alike, near & damped, near & alike, near], ["s", "d", "v", "f"], "o"
        )
    return letters
