"""Whether the probabilities mean what they say."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pandas as pd
import scipy.stats

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.rates import asked
from modalkit.blind.scoring.table import ALL, Rate, measured, number, share

EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Bins of the probability stated, narrower where answers are given [-]."""


SIZES = (1, 2, 3, 4, 5)
"""Sizes of the 95 % set that are counted; larger ones are taken together."""

LEVELS = (0.005, 0.05, 0.25, 0.5, 0.75, 0.95)
"""P-values below which is counted [-]."""

CAME_TRUE, STATED = "first set is the truth, by its probability", "mean probability of the first set"
BRIER, LOG = "Brier score", "log score"
ERROR, BIAS = "expected calibration error", "stated minus right"
BELOW, UNIFORM = "p-value where nothing is hidden, below", "p-value of the Kolmogorov-Smirnov test of these"
HOLDS, MEAN_SIZE, OVER = "set holds the truth", "mean size of the set", f"set of more than {SIZES[-1]}"


def reliability(stated: FloatArray, right: FloatArray) -> Iterator[Rate]:
    """Yield how often a probability stated comes true, and the mean one stated, bin by bin; empty bins are left out.

    Parameters
    ----------
    stated : (n_trials,) array
        Probabilities [-].
    right : (n_trials,) array
        1 where the set was the truth.
    """
    place = bins(stated)
    for k, (low, high) in enumerate(pairwise(EDGES)):
        mine = place == k
        if mine.any():
            group = f"{low:g} to {high:g}"
            yield share(CAME_TRUE, group, right, mine)
            yield number(STATED, group, float(stated[mine].mean()), int(mine.sum()))


def bins(stated: FloatArray) -> np.ndarray:
    """Return the bin of every probability; the last one holds 1."""
    return np.clip(np.searchsorted(EDGES, stated, side="right") - 1, 0, len(EDGES) - 2)


def calibration_error(points: FloatArray) -> FloatArray:
    """Return the expected calibration error: |share right - stated| by bin, weighted by the trials in it.

    Parameters
    ----------
    points : (n_samples, n_trials, 2) array
        Probability stated, and 1 where it was right.

    Returns
    -------
    error : (n_samples,) array
        [-]

    References
    ----------
    M. P. Naeini, G. F. Cooper, M. Hauskrecht, AAAI 2015, 2901, equation 1 (here with the bins of ``EDGES``).
    """
    place, count = bins(points[..., 0]), len(EDGES) - 1
    samples, total = place.shape
    flat = (place + count * np.arange(samples)[:, None]).ravel()
    excess = np.bincount(flat, (points[..., 1] - points[..., 0]).ravel(), minlength=samples * count)
    return np.asarray(np.abs(excess.reshape(samples, count)).sum(axis=1) / total, dtype=float)


def calibration(trials: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield the scores of the probabilities.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial; those whose truth is in the library, or none, have a forecast.
    rng : numpy.random.Generator
        For the intervals.
    """
    some = _with_forecast(trials)
    sure = some[asked(some)]
    visible = some["sort"].isin(["effect", "pair"]) & some["visible"]
    groups = {
        "visible effects, and none": sure,
        "visible effects": some[visible],
        "visible effects, named or in a class": some[visible & some["verdict"].isin(["named", "class"])],
        "effects and none, faint ones too": some,
    }
    for group, these in groups.items():
        points = these[["stated", "first"]].to_numpy(float)
        brier, log = (these[name].to_numpy(float) for name in ("brier", "log"))
        yield measured(BRIER, group, brier, rng)
        yield measured(LOG, group, log, rng)
        yield measured(ERROR, group, points, rng, statistic=calibration_error)
        yield measured(BIAS, group, points[:, 0] - points[:, 1], rng)
    yield from reliability(sure["stated"].to_numpy(float), sure["first"].to_numpy(float))


def _with_forecast(trials: pd.DataFrame) -> pd.DataFrame:
    return trials[trials["stated"].notna()]


def uniformity(trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield how many p-values are below a level where nothing is hidden; of uniform ones it is the level itself."""
    values = trials.loc[trials["sort"] == "none", "p_value"].dropna().to_numpy(float)
    for level in LEVELS:
        yield share(BELOW, f"{level:g}", values < level)
    test = float(scipy.stats.kstest(values, "uniform").pvalue) if len(values) else np.nan
    yield number(UNIFORM, ALL, test, len(values))


def cover(trials: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield coverage and size of the smallest set of rows that holds 95 %, and of the class as stated.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the intervals of the means.
    """
    some = _with_forecast(trials)
    visible = some[some["sort"].isin(["effect", "pair"]) & some["visible"]]
    given = visible[visible["verdict"].isin(["named", "class"])]
    groups = {
        "smallest that holds 95 %, visible effects": (visible["covers"], visible["size"]),
        "smallest that holds 95 %, none and faint too": (some["covers"], some["size"]),
        "as stated, where an effect or a class is named": (given["holds"], given["sets"]),
    }
    for group, (covers, size) in groups.items():
        yield share(HOLDS, group, covers)
        yield measured(MEAN_SIZE, group, size.to_numpy(float), rng)
        for n in SIZES:
            yield share(of_size(n), group, size == n)
        yield share(OVER, group, size > SIZES[-1])


def of_size(sets: int) -> str:
    """Return the question how many sets have a size."""
    return f"set of {sets}"
