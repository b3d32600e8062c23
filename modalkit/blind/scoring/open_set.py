"""Effects outside the library of the diagnosis: separated from those inside, or given a wrong name."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import scipy.stats

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.rates import effect_group, unknowable
from modalkit.blind.scoring.table import ALL, Rate, measured, share

HONEST = "cannot be known: unknown, or an honest equivalent"
AREA = "cannot be known: area under the curve of detection"
ANSWERS = ("unknown", "equivalent", "wrong name", "wrong class", "none", "failed")


def open_set(trials: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield how well the diagnosis recognises what is outside its library, by hidden effect.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the interval of the area.
    """
    among = trials[unknowable(trials)]
    groups = [(f"all, {sort}", some) for sort, some in among.groupby("sort") if some["effect"].nunique() > 1]
    groups += [(effect_group(*map(str, key)), some) for key, some in among.groupby(["sort", "effect"])]
    for group, some in groups:
        yield share(HONEST, group, some["right"])
        for name, mark in _marks(some).items():
            yield share(answer(name), group, mark)
    yield measured(AREA, ALL, detection(trials), rng, statistic=roc_area)


def answer(name: str) -> str:
    """Return the question how often what cannot be known is given one of the ``ANSWERS``."""
    return f"cannot be known: {name}"


def detection(trials: pd.DataFrame) -> FloatArray:
    """Return how unknown each trial looks, 1 - p of the fit of the best row, and 1 where it is.

    Returns
    -------
    (n_trials, 2) array
        Of visible effects with a fit [-].
    """
    known = trials["sort"].isin(["effect", "pair"]) & trials["visible"]
    scored = trials[(known | unknowable(trials)) & trials["fit"].notna()]
    positive = scored["sort"].isin(["outside", "left out"]).to_numpy(float)
    return np.column_stack([1.0 - scored["fit"].to_numpy(float), positive])


def _marks(some: pd.DataFrame) -> dict[str, pd.Series]:
    answers = some["verdict"].isin(["named", "class"])
    wrong = answers & ~some["holds"]
    marks = (
        some["verdict"] == "unknown",
        answers & some["holds"],
        wrong & some["commits"],
        wrong & ~some["commits"],
        some["verdict"] == "none",
        some["verdict"] == "failed",
    )
    return dict(zip(ANSWERS, marks, strict=True))


def roc_curve(value: FloatArray, positive: FloatArray) -> pd.DataFrame:
    """Return false alarms against finds for every threshold.

    Parameters
    ----------
    value : (n_trials,) array
        The larger, the more it looks unknown.
    positive : (n_trials,) array
        1 where it is.

    Returns
    -------
    pandas.DataFrame
        ``false`` alarms on known effects and unknown ones ``found``, by ``threshold`` [-].
    """
    thresholds = np.unique(value)[::-1]
    over = value[None, :] >= thresholds[:, None]
    yes, no = positive.sum(), len(positive) - positive.sum()
    found = (over * positive).sum(axis=1) / max(yes, 1)
    false = (over * (1 - positive)).sum(axis=1) / max(no, 1)
    return pd.DataFrame({"threshold": thresholds, "false": false, "found": found})


def roc_area(points: FloatArray) -> FloatArray:
    """Return the area under the ROC curve: the chance that an unknown one looks more unknown than a known one.

    Parameters
    ----------
    points : (n_samples, n_trials, 2) array
        Value, and 1 where it is unknown.

    References
    ----------
    J. A. Hanley, B. J. McNeil, Radiology 143 (1982) 29 (the area is the Mann-Whitney statistic).
    """
    value, positive = points[..., 0], points[..., 1]
    ranks = scipy.stats.rankdata(value, axis=1)
    yes = positive.sum(axis=1)
    no = positive.shape[1] - yes
    with np.errstate(invalid="ignore", divide="ignore"):
        area = ((ranks * positive).sum(axis=1) - yes * (yes + 1) / 2) / (yes * no)
    return np.asarray(area, dtype=float)
