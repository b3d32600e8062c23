"""How strong: stated parameters against hidden ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.answer import Row
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.intervals import median
from modalkit.blind.scoring.judge import accepted, holds, label
from modalkit.blind.scoring.table import ALL, Rate, measured, number, share

NOT_SCORED = (
    *("local_stiffness.extent", "local_stiffness.extent_y", "local_stiffness.loss"),
    *("local_mass.extent", "local_mass.extent_y", "local_mass.factor"),
)
"""What data do not determine one by one, and what a box, a cosine and a slot, a sheet and ice mean differently; the
compliance, and the mass, stand for all of them."""

PLACES = ("x", "y")
"""Coordinates are errors of place."""

_COLUMNS = [
    "trial",
    "effect",
    "parameter",
    "true",
    "value",
    "low95",
    "high95",
    "error",
    "covered",
    "committed",
]


def severity_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return one row per parameter of an effect that was rightly named or held by a class.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        ``true``, ``value``, ``low95``, ``high95`` [SI], ``error`` relative to the true value [-], whether the interval
        ``covered`` it (None where there is none), and whether that set alone was the answer (``committed``). A
        parameter that is truly 0 has no relative error, and no interval inside its prior can hold it: left out.
    """
    rows = [row for o in outcomes for row in _rows(o)]
    return pd.DataFrame(rows, columns=_COLUMNS)


def _rows(outcome: Outcome) -> list[list[Any]]:
    own = true_row(outcome)
    if own is None or outcome.answer is None:
        return []
    rows = []
    for name, true in outcome.truth.parameters.items():
        if name in NOT_SCORED or name.split(".")[-1] in PLACES or name not in own.parameters:
            continue
        if not isinstance(true, int | float) or not true:
            continue
        e = own.parameters[name]
        covered = bool(e.low <= true <= e.high) if np.isfinite([e.low, e.high]).all() else None
        error = e.value / true - 1
        start = [outcome.index, label(outcome.truth.effects), name]
        rows.append([*start, true, e.value, e.low, e.high, error, covered, outcome.answer.verdict == "named"])
    return rows


def true_row(outcome: Outcome) -> Row | None:
    """Return the row of the hidden set itself, where the answer holds it or what is the same; None elsewhere."""
    answer, truth = outcome.answer, outcome.truth
    if answer is None or not truth.effects or not holds(answer, truth):
        return None
    own = frozenset(truth.effects)
    return answer.row(own) if own in answer.sets and accepted(own, truth) else None


INSIDE, ERROR, BIAS = (
    "parameter inside its 95 % interval",
    "median error of a parameter",
    "mean error of a parameter",
)
SAME_POINTS = "the same points"


def severity(table: pd.DataFrame, points: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield errors and coverage by parameter, and of all; and how often lists of points are right.

    Parameters
    ----------
    table, points : pandas.DataFrame
        As :func:`severity_table` and :func:`point_table` return them.
    rng : numpy.random.Generator
        For the intervals of the medians.
    """
    for group, some in [(ALL, table), *table.groupby("parameter")]:
        if len(some):
            errors = some["error"].dropna().to_numpy(float)
            yield share(INSIDE, str(group), some["covered"].dropna().astype(bool))
            yield measured(ERROR, str(group), np.abs(errors), rng, statistic=median)
            yield number(BIAS, str(group), float(errors.mean()) if len(errors) else np.nan, len(errors))
    for group, some in points.groupby("parameter"):
        yield share(SAME_POINTS, str(group), some["same"])


def point_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return one row per list of test points that was hidden, where the answer holds the effect.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        ``true`` and ``said`` points, those of the answer, and whether they are the same.
    """
    rows = []
    for outcome in outcomes:
        row = true_row(outcome)
        for name, points in () if row is None else row.points.items():
            true = outcome.truth.parameters.get(name)
            if true is None:
                continue
            own = tuple(true) if isinstance(true, list | tuple) else (int(true),)
            rows.append([outcome.index, name, str(own), str(points), sorted(own) == sorted(points)])
    return pd.DataFrame(rows, columns=["trial", "parameter", "true", "said", "same"])
