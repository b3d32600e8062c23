"""Sums and differences of natural frequencies, at which a nonlinear joint makes peaks."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from scipy import stats

from acquisition.arrays import FloatArray
from acquisition.quantities import hertz
from identification.model import ModalModel

ORDERS = (2, 3)
"""Numbers of natural frequencies in a sum [-]: what a joint makes at higher orders is fainter."""

CHANCE = 1e-3
"""Chance by which modes lie so near to sums of stronger ones, under which a warning names them [-]. Ten times as much
warns of one structure in a hundred."""

NEAR = 0.1
"""Chance of its distance alone, under which a mode is among those named [-]."""

SOURCES = 6
"""Strongest modes among which sums are sought where only frequencies are known [-]. Twice as many have sums
everywhere."""


def combination(frequency: float, sources: FloatArray, tolerance: FloatArray) -> str | None:
    """Return the sum of two or three natural frequencies that is nearest to a frequency, as text, or None.

    Parameters
    ----------
    frequency : float
        Where it is sought [Hz].
    sources, tolerance : (n,) arrays
        Natural frequencies, and by how much each may be off [Hz].
    """
    for order in ORDERS:
        counts = _counts(len(sources), order)
        apart = np.abs(counts @ sources - frequency)
        near = np.flatnonzero(apart <= np.abs(counts) @ tolerance)
        if len(near):
            return _named(counts[near[apart[near].argmin()]], sources)
    return None


def _counts(n: int, order: int) -> FloatArray:
    """Return how often each of n frequencies is in the sums of so many, differences included, (n_sums, n)."""
    chosen = np.array(list(combinations_with_replacement(range(2 * n), order)), dtype=np.int64).reshape(
        -1, order
    )
    counts = np.zeros((len(chosen), n))
    for column in chosen.T:
        np.add.at(counts, (np.arange(len(chosen)), column % n), np.where(column < n, 1.0, -1.0))
    whole = np.abs(counts).sum(axis=1) == order
    return np.asarray(counts[whole])


def _named(counts: FloatArray, sources: FloatArray) -> str:
    """Return a sum of frequencies as text, what is added first."""
    text = ""
    for k in np.argsort(-counts, kind="stable"):
        if counts[k]:
            sign = (" + " if text else "") if counts[k] > 0 else " - "
            times = "" if abs(counts[k]) == 1 else f"{abs(counts[k]):.0f} x "
            text += f"{sign}{times}{hertz(sources[k])}"
    return text


def coincidences(model: ModalModel) -> dict[int, str]:
    """Return modes nearer to sums or differences of stronger ones than chance puts them.

    Under chance the distance from the nearest sum is that of a random place of the band. The chances of all modes are
    combined after Fisher (Statistical Methods for Research Workers, 1932, section 21.1).

    Returns
    -------
    dict of int to str
        The sum for each of these modes, from 0; empty where chance explains all distances.
    """
    own, off = model.modal.frequency, model.modal.frequency_sigma
    height = np.sum(np.abs(model.constants / model.poles.real) ** 2, axis=0)
    strong = np.argsort(-height)
    chances, named = {}, {}
    for place, r in enumerate(strong[1:].tolist(), start=1):
        above = strong[: min(place, SOURCES)]
        chances[r], named[r] = _nearest(own[r], off[r], own[above], model.band)
    total = -2 * np.sum(np.log(list(chances.values())))
    if not chances or stats.chi2.sf(total, 2 * len(chances)) > CHANCE:
        return {}
    return {r: named[r] for r in sorted(chances) if chances[r] < NEAR}


def _nearest(
    frequency: float, sigma: float, sources: FloatArray, band: tuple[float, float]
) -> tuple[float, str]:
    """Return the chance that a random frequency lies as near to a sum of sources, and that sum as text."""
    found = []
    for order in ORDERS:
        counts = _counts(len(sources), order)
        place = counts @ sources
        inside = (place > band[0]) & (place < band[1])
        if inside.any():
            apart = np.abs(place[inside] - frequency)
            within = 2 * max(float(apart.min()), sigma) * np.count_nonzero(inside) / (band[1] - band[0])
            found.append((-np.expm1(-len(ORDERS) * within), _named(counts[inside][apart.argmin()], sources)))
    return min(found, default=(1.0, ""))
