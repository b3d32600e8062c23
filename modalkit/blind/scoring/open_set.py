"""Effects that the diagnosis cannot know: told from those it knows, or given a wrong name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import scipy.stats

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.intervals import bootstrap, share
from modalkit.blind.scoring.rates import unknowable


@dataclass(frozen=True, eq=False)
class OpenSet:
    """Detection of what is not in the library.

    Parameters
    ----------
    effects : pandas.DataFrame
        By hidden effect, and of all: counts and shares of ``unknown``, ``equivalent``, ``wrong name``,
        ``wrong class``, ``none``, ``failed``, and the share that is honest with its interval.
    roc : pandas.DataFrame
        ``false`` alarms on known effects against ``found`` unknown ones, by ``threshold`` of 1 - p of fit [-].
    area : dict
        Area under that curve with its bootstrap interval; 0.5 is chance [-].
    """

    effects: pd.DataFrame
    roc: pd.DataFrame
    area: dict[str, Any]


def open_set(trials: pd.DataFrame, rng: np.random.Generator) -> OpenSet:
    """Return how well the diagnosis knows what it does not know.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the interval of the area.
    """
    among = trials[unknowable(trials)]
    groups = [(f"all, {sort}", some) for sort, some in among.groupby("sort") if some["effect"].nunique() > 1]
    groups += [(f"{effect} ({sort})", some) for (sort, effect), some in among.groupby(["sort", "effect"])]
    effects = pd.DataFrame([{"effect": name} | _row(some) for name, some in groups])
    known = trials["sort"].isin(["effect", "pair"]) & trials["visible"]
    scored = trials[(known | unknowable(trials)) & trials["fit"].notna()]
    positive = scored["sort"].isin(["outside", "left out"]).to_numpy(float)
    points = np.column_stack([1.0 - scored["fit"].to_numpy(float), positive])
    return OpenSet(effects, roc_curve(points[:, 0], points[:, 1]), bootstrap(points, rng, statistic=roc_area))


def _row(some: pd.DataFrame) -> dict[str, Any]:
    answers = some["verdict"].isin(["named", "class"])
    wrong = answers & ~some["holds"]
    counts = {
        "unknown": some["verdict"] == "unknown",
        "equivalent": answers & some["holds"],
        "wrong name": wrong & some["commits"],
        "wrong class": wrong & ~some["commits"],
        "none": some["verdict"] == "none",
        "failed": some["verdict"] == "failed",
    }
    return {name: int(hit.sum()) for name, hit in counts.items()} | share(some["right"])


def roc_curve(value: FloatArray, positive: FloatArray) -> pd.DataFrame:
    """Return false alarms against finds for every threshold.

    Parameters
    ----------
    value : (n_trials,) array
        The larger, the more it looks unknown.
    positive : (n_trials,) array
        1 where it is.
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
