"""How far the gap closes: what the diagnosis states against what comes true on the rig."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.judge import holds, label, sort_of
from modalkit.blind.scoring.table import ALL, Rate, measured, number, share

WITHIN = 10.0
"""Points of per cent within which a prediction counts as met [%]."""

_COLUMNS = [
    *("trial", "effect", "sort", "metric", "true_metric", "said", "low95", "high95"),
    *("true", "beyond", "held_out", "covered", "held"),
]


def closing_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return one row per trial in which both are known.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        Share of the gap that closes [%]: ``said`` with ``low95`` and ``high95``, ``held_out`` (from the errors on
        data held out), ``true`` on the rig's own modes in the band and ``beyond`` on those above it; ``covered``:
        the true one lies in the interval; ``held``: the answer holds the hidden effect.
    """
    rows = [row for outcome in outcomes if (row := _row(outcome)) is not None]
    return pd.DataFrame(rows, columns=_COLUMNS)


def _row(outcome: Outcome) -> list[Any] | None:
    answer, true = outcome.answer, outcome.shrinkage
    if answer is None or true is None:
        return None
    share_true = closed(true.before_percent, true.after_percent)
    share_beyond = closed(true.beyond_before_percent, true.beyond_after_percent)
    estimate = answer.closed
    inside = (
        None
        if estimate is None or np.isnan(estimate.low + estimate.high)
        else bool(estimate.low <= share_true <= estimate.high)
    )
    out = answer.held_out
    held_out = closed(
        out.get("before_percent"), out.get("after_percent"), out.get("noise_floor_percent") or 0.0
    )
    start = [outcome.index, label(outcome.truth.effects), sort_of(outcome.truth), answer.metric, true.metric]
    stated = [np.nan] * 3 if estimate is None else [estimate.value, estimate.low, estimate.high]
    return [*start, *stated, share_true, share_beyond, held_out, inside, holds(answer, outcome.truth)]


def closed(before: float | None, after: float | None, floor: float = 0.0) -> float:
    """Return the share of the closable gap that closes, 1 - (after^2 - floor^2) / (before^2 - floor^2) [%].

    Parameters
    ----------
    before, after : float or None
        R.m.s. errors [%].
    floor : float
        Repeatability [%].

    Returns
    -------
    float
        nan where there is nothing to close [%].
    """
    if before is None or after is None or not before > 1.5 * floor or not np.isfinite(before + after):
        return float("nan")
    return 100.0 * (1.0 - max(after**2 - floor**2, 0.0) / (before**2 - floor**2))


def comparable(table: pd.DataFrame) -> pd.DataFrame:
    """Return the trials in which answer and truth concern the same quantity, frequency or damping.

    Parameters
    ----------
    table : pandas.DataFrame
        As :func:`closing_table` returns it.
    """
    return table[(table["said"] + table["true"]).notna() & (table["metric"] == table["true_metric"])]


MET, MISSED = "closes as stated, within 10 points of per cent", "mean |stated - true| closing [%]"
STATED, TRUE, BEYOND = "mean closing stated [%]", "mean closing true [%]", "mean closing above the band [%]"
INSIDE = "true closing inside its 95 % interval"


def closing(table: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield how well the shrinkage is predicted.

    Parameters
    ----------
    table : pandas.DataFrame
        As :func:`closing_table` returns it.
    rng : numpy.random.Generator
        For the intervals.
    """
    stated = comparable(table)
    held = stated["held"].astype(bool)
    outside = stated["sort"].isin(["outside", "left out"])
    groups = {
        ALL: stated,
        "answer holds the truth": stated[held],
        "answer is false": stated[~held],
        "wrong name for what cannot be known": stated[outside & ~held],
    } | {f"gap of {metric}": some for metric, some in stated.groupby("metric")}
    for group, some in groups.items():
        if len(some):
            distance = (some["said"] - some["true"]).abs().to_numpy(float)
            yield share(MET, group, distance <= WITHIN)
            yield measured(MISSED, group, distance, rng)
            for question, column in ((STATED, "said"), (TRUE, "true"), (BEYOND, "beyond")):
                yield number(question, group, some[column].mean(), int(some[column].notna().sum()))
            yield share(INSIDE, group, some["covered"].dropna().astype(bool))
