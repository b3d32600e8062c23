"""Intervals: Wilson's for shares, the bootstrap over trials for everything else.

Those of scipy.stats, and the same numbers, wherever scipy has them. Here counts may be fractions and come in arrays,
one trial is enough, a statistic may be undefined in some samples, and a trial may have several numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import ArrayLike

from acquisition.arrays import FloatArray, IntArray

Z95 = 1.959963984540054
"""Quantile of the normal distribution that leaves 2.5 % above [-]."""

RESAMPLES = 1000
"""Samples drawn with replacement for a bootstrap [-]."""

Statistic = Callable[[FloatArray], FloatArray]
"""Takes (n_samples, n_trials, ...) to (n_samples,)."""

LARGEST = 1_000_000
"""Numbers held at a time in a bootstrap [-]."""


def wilson(count: ArrayLike, total: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the 95 % Wilson interval of shares.

    Parameters
    ----------
    count, total : (...) array_like
        Hits, and trials; counts may be fractions, where a class is counted by its share.

    Returns
    -------
    low, high : (...) array
        Bounds; nan where there are no trials [-].

    References
    ----------
    E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
    """
    hits, n = np.asarray(count, dtype=float), np.asarray(total, dtype=float)
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = hits / n
        middle = (rate + Z95**2 / (2 * n)) / (1 + Z95**2 / n)
        half = Z95 / (1 + Z95**2 / n) * np.sqrt(rate * (1 - rate) / n + Z95**2 / (4 * n**2))
    empty = n <= 0
    low = np.where(hits <= 0, 0.0, np.maximum(middle - half, 0.0))
    high = np.where(hits >= n, 1.0, np.minimum(middle + half, 1.0))
    return np.where(empty, np.nan, low), np.where(empty, np.nan, high)


def resampled(total: int, rng: np.random.Generator) -> Iterator[IntArray]:
    """Yield the indices of bootstrap samples of trials, (n_samples, total) at a time, as memory allows."""
    at_a_time = max(1, min(RESAMPLES, LARGEST // total))
    for done in range(0, RESAMPLES, at_a_time):
        yield rng.integers(total, size=(min(at_a_time, RESAMPLES - done), total))


def bootstrap(
    values: FloatArray,
    rng: np.random.Generator,
    *,
    statistic: Statistic | None = None,
) -> tuple[float, float, float]:
    """Return a statistic with its 95 % percentile interval over trials.

    Parameters
    ----------
    values : (n_trials, ...) array
        One row per trial.
    rng : numpy.random.Generator
        Draws the samples.
    statistic : callable, optional
        Default the mean.

    Returns
    -------
    value, low, high : float
        nan without trials.

    References
    ----------
    B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap, 1993, chapter 13.
    """
    if not len(values):
        return math.nan, math.nan, math.nan
    measure = statistic or _mean
    many = np.concatenate([measure(values[part]) for part in resampled(len(values), rng)])
    low, high = np.nanquantile(many, [0.025, 0.975]) if np.isfinite(many).any() else (math.nan, math.nan)
    return float(measure(values[None])[0]), float(low), float(high)


def _mean(values: FloatArray) -> FloatArray:
    return np.asarray(values.mean(axis=1), dtype=float)


def median(values: FloatArray) -> FloatArray:
    """Return the median of each sample, (n_samples, n_trials) to (n_samples,)."""
    return np.asarray(np.median(values, axis=1), dtype=float)
