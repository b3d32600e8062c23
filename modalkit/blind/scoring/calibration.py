"""Whether the probabilities mean what they say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
import scipy.stats

from acquisition.arrays import FloatArray
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.intervals import bootstrap, share, wilson
from modalkit.blind.scoring.posterior import posterior
from modalkit.blind.scoring.rates import asked

EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Bins of the probability stated, narrower where answers are given [-]."""

LEAST = 1e-6
"""Probability below which the log score counts no further: one bad trial must not decide it [-]."""


def forecast_table(outcomes: Sequence[Outcome], trials: pd.DataFrame) -> pd.DataFrame:
    """Return what each answered trial forecast.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.
    trials : pandas.DataFrame
        One row per trial.

    Returns
    -------
    pandas.DataFrame
        By trial, of those whose truth is in the library or none: ``stated`` probability of the first set,
        whether it is ``right``, ``brier``, ``log`` score -ln p [-], ``size`` of the smallest set of rows that
        holds 95 % and whether it ``covers`` the truth.
    """
    rows = []
    for outcome in outcomes:
        if outcome.answer is None or trials.loc[outcome.index, "sort"] not in ("effect", "pair", "none"):
            continue
        stated = posterior(outcome.answer, outcome.truth)
        size, covers = stated.credible()
        log = -float(np.log(max(stated.truth, LEAST)))
        first = float(stated.probability[0])
        rows.append([outcome.index, first, stated.first_is_right, stated.brier, log, size, covers])
    columns = ["trial", "stated", "right", "brier", "log", "size", "covers"]
    table = pd.DataFrame(rows, columns=columns).set_index("trial")
    return table.astype({"right": bool, "covers": bool})


def reliability_table(stated: FloatArray, right: FloatArray) -> pd.DataFrame:
    """Return how often a probability stated comes true, bin by bin.

    Parameters
    ----------
    stated : (n_trials,) array
        Probabilities [-].
    right : (n_trials,) array
        1 where the set was the truth.

    Returns
    -------
    pandas.DataFrame
        ``low``, ``high`` of the bin, ``count`` of ``total``, mean ``stated``, ``rate`` and its interval; empty bins
        are left out.
    """
    place = bins(stated)
    total = np.bincount(place, minlength=len(EDGES) - 1)
    count = np.bincount(place, right, minlength=len(EDGES) - 1)
    mean = np.bincount(place, stated, minlength=len(EDGES) - 1) / np.maximum(total, 1)
    low, high = wilson(count, total)
    table = pd.DataFrame(
        {
            "low": EDGES[:-1],
            "high": EDGES[1:],
            "count": count.astype(int),
            "total": total,
            "stated": mean,
            "rate": count / np.maximum(total, 1),
            "low95": low,
            "high95": high,
        }
    )
    return table[table["total"] > 0].reset_index(drop=True)


def bins(stated: FloatArray) -> np.ndarray:
    """Return the bin of every probability; the last one holds 1."""
    return np.clip(np.searchsorted(EDGES, stated, side="right") - 1, 0, len(EDGES) - 2)


def calibration_error(points: FloatArray) -> FloatArray:
    """Return the expected calibration error: |share right - stated| by bin, weighed by the trials in it.

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


def calibration_table(
    forecasts: pd.DataFrame, trials: pd.DataFrame, rng: np.random.Generator
) -> pd.DataFrame:
    """Return the scores of the probabilities with their bootstrap intervals.

    Parameters
    ----------
    forecasts : pandas.DataFrame
        As :func:`forecast_table` returns them.
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the intervals.

    Returns
    -------
    pandas.DataFrame
        ``trials`` (which), ``measure``, ``total``, ``value``, ``low95``, ``high95``.
    """
    of = trials.loc[forecasts.index]
    visible = of["sort"].isin(["effect", "pair"]) & of["visible"]
    groups = {
        "visible effects, and none": asked(of),
        "visible effects": visible,
        "visible effects, named or in a class": visible & of["verdict"].isin(["named", "class"]),
        "effects and none, faint ones too": pd.Series(True, index=of.index),
    }
    rows = []
    for name, among in groups.items():
        some = forecasts[among]
        points = some[["stated", "right"]].to_numpy(float)
        measured = {
            "Brier score": bootstrap(some["brier"].to_numpy(float), rng),
            "log score": bootstrap(some["log"].to_numpy(float), rng),
            "expected calibration error": bootstrap(points, rng, statistic=calibration_error),
            "stated minus right": bootstrap(points[:, 0] - points[:, 1], rng),
        }
        rows += [{"trials": name, "measure": measure} | values for measure, values in measured.items()]
    return pd.DataFrame(rows)


def uniformity_table(trials: pd.DataFrame) -> pd.DataFrame:
    """Return whether the p-value is uniform where nothing is hidden.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.

    Returns
    -------
    pandas.DataFrame
        For each ``level`` the share of p-values below it with its interval; uniform ones have the level itself.
        The ``ks_p`` of the Kolmogorov-Smirnov test against a uniform distribution stands in every row.
    """
    values = trials.loc[trials["sort"] == "none", "p_value"].dropna().to_numpy(float)
    ks = float(scipy.stats.kstest(values, "uniform").pvalue) if len(values) else np.nan
    return pd.DataFrame(
        [
            {"level": level} | share(values < level) | {"ks_p": ks}
            for level in (0.005, 0.05, 0.25, 0.5, 0.75, 0.95)
        ]
    )
