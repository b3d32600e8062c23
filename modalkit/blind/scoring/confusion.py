"""What was hidden against what was answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.judge import accepted, is_right, label, sort_of


def answer_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return every answer as shares: a class gives each of its sets an equal part of the trial.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        ``trial``, ``sort``, ``hidden``, ``answer``, ``share`` [-] and whether that answer is ``true``; the shares
        of a trial add up to 1.
    """
    rows = [row for outcome in outcomes for row in _shares(outcome)]
    return pd.DataFrame(rows, columns=["trial", "sort", "hidden", "answer", "share", "true"])


def _shares(outcome: Outcome) -> list[list[Any]]:
    truth, answer = outcome.truth, outcome.answer
    start = [outcome.index, sort_of(truth), label(truth.effects)]
    if answer is None:
        return [[*start, "failed", 1.0, False]]
    if answer.verdict in ("unknown", "none"):
        return [[*start, answer.verdict, 1.0, is_right(answer, truth)]]
    if not answer.sets:
        return [[*start, "named nothing", 1.0, False]]
    part = 1.0 / len(answer.sets)
    return [[*start, label(s), part, accepted(s, truth)] for s in answer.sets]


def confusion_matrix(answers: pd.DataFrame) -> pd.DataFrame:
    """Return hidden effect (rows) against answer (columns), in trials; rows add up to whole trials."""
    return answers.pivot_table(
        index="hidden", columns="answer", values="share", aggfunc="sum", fill_value=0.0
    )
