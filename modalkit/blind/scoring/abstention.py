"""What is answered against how often it is right: the price of waiting until one is sure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.intervals import bootstrap, share, wilson
from modalkit.blind.scoring.rates import asked, unknowable


@dataclass(frozen=True, eq=False)
class Abstention:
    """The abstention curve.

    Parameters
    ----------
    curve : pandas.DataFrame
        For every ``threshold`` that changes anything: ``committed`` and ``count`` right of ``total``, the share
        ``answered``, the share ``right`` of those answered, and its 95 % Wilson interval [-].
    area : dict
        Mean share right over all shares answered, with its bootstrap interval [-].
    rule : dict
        The diagnosis's own rule: share ``answered``, and ``rate`` right with its interval [-].
    """

    curve: pd.DataFrame
    area: dict[str, Any]
    rule: dict[str, Any]


def abstention(trials: pd.DataFrame, rng: np.random.Generator, *, outside: bool = False) -> Abstention:
    """Return the abstention curve.

    A trial is answered at threshold t if the probability of the first set is at least t; no effect counts as a
    set, an answer ``unknown`` is never given, and a diagnosis that failed neither.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the interval of the area.
    outside : bool
        Whether effects that the diagnosis cannot know are among them: every set but an honest equivalent is
        false there.

    Returns
    -------
    Abstention
        Of the trials with a visible effect, and without any.

    References
    ----------
    M. S. A. Nadeem, J.-D. Zucker, B. Hanczar, JMLR W&CP 8 (2010) 65 (accuracy-rejection curves).
    """
    among = asked(trials) | unknowable(trials) if outside else asked(trials)
    kept = trials[among]
    confidence, first = kept["confidence"].to_numpy(float), kept["first"].to_numpy(float)
    given = kept["commits"] | (kept["verdict"] == "none")
    rule = share(kept["right"] & given, given)
    rule |= {"answered": float(given.mean()) if len(kept) else np.nan, "of": len(kept)}
    points = np.column_stack([confidence, first * (confidence > 0)])
    return Abstention(curve(confidence, first), bootstrap(points, rng, statistic=area), rule)


def curve(confidence: FloatArray, right: FloatArray) -> pd.DataFrame:
    """Return share answered and share right for every threshold.

    Parameters
    ----------
    confidence : (n_trials,) array
        Probability of the first set; 0 where nothing is said at any threshold [-].
    right : (n_trials,) array
        1 where that set is the truth.
    """
    total = len(confidence)
    thresholds = np.unique(confidence[confidence > 0])[::-1]
    order = np.argsort(-confidence, kind="stable")
    committed = np.searchsorted(-confidence[order], -thresholds, side="right")
    count = np.concatenate([[0.0], np.cumsum(right[order])])[committed]
    low, high = wilson(count, committed)
    return pd.DataFrame(
        {
            "threshold": thresholds,
            "committed": committed,
            "count": count.astype(int),
            "total": total,
            "answered": committed / max(total, 1),
            "right": count / np.maximum(committed, 1),
            "low95": low,
            "high95": high,
        }
    )


def area(points: FloatArray) -> FloatArray:
    """Return the mean over k of the share right among the k most confident, equal ones in random order.

    Parameters
    ----------
    points : (n_samples, n_trials, 2) array
        Probability of the first set, and 1 where it is the truth [-].

    Returns
    -------
    area : (n_samples,) array
        1 is perfect [-].
    """
    confidence, right = points[..., 0], points[..., 1]
    order = np.argsort(-confidence, axis=1, kind="stable")
    sure = np.take_along_axis(confidence, order, axis=1)
    hits = _level(sure, np.take_along_axis(right, order, axis=1))
    ranks = np.arange(1, hits.shape[1] + 1)
    return np.asarray((np.cumsum(hits, axis=1) / ranks).mean(axis=1), dtype=float)


def _level(sure: FloatArray, right: FloatArray) -> FloatArray:
    """Give trials of equal confidence their mean share right; both arrays sorted, (n_samples, n_trials)."""
    n = sure.shape[1]
    new = np.ones_like(sure, dtype=bool)
    new[:, 1:] = sure[:, 1:] != sure[:, :-1]
    group = np.cumsum(new.ravel()) - 1
    mean = np.bincount(group, right.ravel()) / np.bincount(group)
    return np.asarray(mean[group].reshape(-1, n), dtype=float)
