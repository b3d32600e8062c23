"""What is answered against how often it is right: the price of waiting until one is sure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.intervals import wilson
from modalkit.blind.scoring.rates import asked, unknowable
from modalkit.blind.scoring.table import Rate, measured, share

AREA = "area under the curve of right against answered"
ANSWERED, RIGHT = "answered by its own rule", "right when answered by its own rule"
KNOWN, BOTH = "effects of the library, and none", "effects it cannot know, too"

THRESHOLDS = (0.5, 0.8, 0.9, 0.95, 0.99, 0.999)
"""Probabilities from which one might answer [-]."""


def asked_of(trials: pd.DataFrame, group: str) -> pd.DataFrame:
    """Return the trials of one of the two groups.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    group : {KNOWN, BOTH}
        Those with a visible effect of the library, or without any; or also those with an effect that the diagnosis
        cannot know: every set but an honest equivalent is false there.
    """
    return trials[asked(trials) | unknowable(trials) if group == BOTH else asked(trials)]


def abstention(trials: pd.DataFrame, group: str, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield what is answered against how often it is right, by the probability from which one answers.

    A trial is answered at threshold t if the probability of the first set is at least t; no effect counts as a
    set, an answer ``unknown`` is never given, and a diagnosis that failed neither.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    group : {KNOWN, BOTH}
        As :func:`asked_of` takes it.
    rng : numpy.random.Generator
        For the interval of the area.

    References
    ----------
    M. S. A. Nadeem, J.-D. Zucker, B. Hanczar, JMLR W&CP 8 (2010) 65 (accuracy-rejection curves).
    """
    kept = asked_of(trials, group)
    confidence, first = kept["confidence"].to_numpy(float), kept["first"].to_numpy(float)
    given = kept["commits"] | (kept["verdict"] == "none")
    yield share(ANSWERED, group, given)
    yield share(RIGHT, group, kept["right"], given)
    for t in THRESHOLDS:
        yield share(answered_from(t), group, confidence >= t)
        yield share(right_from(t), group, first, confidence >= t)
    points = np.column_stack([confidence, first * (confidence > 0)])
    yield measured(AREA, group, points, rng, statistic=area)


def answered_from(threshold: float) -> str:
    """Return the question how many are answered from a probability."""
    return f"answered from a probability of {threshold:g}"


def right_from(threshold: float) -> str:
    """Return the question how many of those are right."""
    return f"right when answered from a probability of {threshold:g}"


def curve(confidence: FloatArray, right: FloatArray) -> pd.DataFrame:
    """Return share answered and share right for every threshold.

    Parameters
    ----------
    confidence : (n_trials,) array
        Probability of the first set; 0 where no answer is given at any threshold [-].
    right : (n_trials,) array
        1 where that set is the truth.

    Returns
    -------
    pandas.DataFrame
        For every ``threshold`` that changes anything: how many it has ``committed``, and the ``count`` of them that
        are right; the share ``answered``, the share ``right`` of those answered, and its 95 % interval, ``low`` and
        ``high`` [-].
    """
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
            "answered": committed / max(len(confidence), 1),
            "right": count / np.maximum(committed, 1),
            "low": low,
            "high": high,
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
