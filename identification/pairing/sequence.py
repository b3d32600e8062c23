"""Pairing by frequency alone: both sets in order, with gaps, and a factor in common."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray


def in_order(test: FloatArray, model: FloatArray, limit: float, spread: float) -> list[tuple[int, int]]:
    """Pair without shapes: the cheapest order-keeping sequence over a range of common factors.

    Parameters
    ----------
    test, model : (n,) arrays
        Frequencies [Hz].
    limit : float
        Largest logarithm of the common factor, either way [-].
    spread : float
        Relative scatter about the factor that is nothing unusual [-].
    """
    rows, columns = np.argsort(test), np.argsort(model)
    shift = np.log(model[columns])[None, :] - np.log(test[rows])[:, None]
    best: tuple[float, list[tuple[int, int]]] = (np.inf, [])
    for centre in _centres(shift, limit):
        cost, found = _monotone(((shift - centre) / spread) ** 2)
        cost += 0.05 * (centre / limit) ** 2
        if cost < best[0]:
            best = (cost, found)
    return [(int(rows[i]), int(columns[j])) for i, j in best[1]]


def _centres(shift: FloatArray, limit: float) -> FloatArray:
    """Return the common factors worth trying: those that bring some pair to agree, and none."""
    flat: Sequence[float] | FloatArray = shift[np.abs(shift) <= limit]
    return np.unique(np.round(np.append(flat, 0.0), 3))


def _monotone(price: FloatArray, *, alone: float = 2.0) -> tuple[float, list[tuple[int, int]]]:
    """Find the cheapest order-keeping pairing with gaps: sequence alignment by dynamic programming.

    Needleman and Wunsch, J. Mol. Biol. 48 (1970) 443-453. A test mode left alone costs ``alone``; a model
    mode between two paired ones a tenth of that, one beyond them nothing: a model has more modes than a test.
    """
    n, m = price.shape
    gap = 0.1 * alone
    table = np.full((n + 1, m + 1), np.inf)
    table[:, 0], table[0] = alone * np.arange(n + 1), 0.0
    for i in range(1, n + 1):
        step = np.minimum(table[i - 1, :-1] + price[i - 1], table[i - 1, 1:] + alone)
        cost = gap if i < n else 0.0
        ramp = cost * np.arange(1, m + 1)
        table[i, 1:] = np.minimum.accumulate(np.minimum(step - ramp, table[i, 0])) + ramp
    found, i, j = [], n, m
    while i > 0 and j > 0:
        if np.isclose(table[i, j], table[i - 1, j - 1] + price[i - 1, j - 1], rtol=1e-12, atol=1e-12):
            i, j = i - 1, j - 1
            found.append((i, j))
        elif np.isclose(table[i, j], table[i - 1, j] + alone, rtol=1e-12, atol=1e-12):
            i -= 1
        else:
            j -= 1
    return float(table[n, m]), found[::-1]
