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
"""Chance by which so many modes lie at sums of stronger ones, under which a word is said [-]. Ten times as much says
it of one structure in a hundred."""

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
    """Return modes at sums or differences of stronger ones, where more are there than chance puts there.

    Returns
    -------
    dict of int to str
        The sum for each of these modes, from 0; empty where chance explains their number.
    """
    poles, low, high = model.poles, *model.band
    own, width = model.modal.frequency, -poles.real / (2 * np.pi) + model.modal.frequency_sigma
    height = np.sum(np.abs(model.constants / poles.real) ** 2, axis=0)
    found, expected = {}, 0.0
    strong = np.argsort(-height)
    for place, r in enumerate(strong[1:], start=1):
        above = strong[: min(place, SOURCES)]
        named = combination(float(own[r]), own[above], width[above])
        if named is not None:
            found[int(r)] = named
        expected += _expected(own[above], width[above], (low, high))
    sure = stats.poisson.sf(len(found) - 1, expected) < CHANCE
    return dict(sorted(found.items())) if sure else {}


def _expected(sources: FloatArray, tolerance: FloatArray, band: tuple[float, float]) -> float:
    """Return the chance that a frequency anywhere in a band lies at a sum of sources [-]."""
    counts = np.concatenate([_counts(len(sources), order) for order in ORDERS])
    place = counts @ sources
    inside = (place > band[0]) & (place < band[1])
    return float(min(1.0, np.sum(2.0 * np.abs(counts[inside]) @ tolerance) / (band[1] - band[0])))
