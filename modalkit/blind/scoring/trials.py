"""Hidden effects compared with the answers, trial by trial."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.answer import Answer
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.judge import (
    accepted,
    commits,
    credit,
    holds,
    is_right,
    label,
    sort_of,
    top_is_right,
)
from modalkit.blind.scoring.posterior import Posterior, posterior
from modalkit.blind.trial import Truth

VISIBLE = 3.0
"""Standard deviations from which an effect is expected to be seen [-]."""

LEFT_VISIBLE = 5.0
"""Standard deviations that the best effect of the library has to leave of one that it lacks, before to name the
library's is wrong: below, the two differ by no more than noise and linearisation do [-]."""

_FAILED: dict[str, Any] = {
    "verdict": "failed",
    "answered": "failed",
    "sets": 0,
    "right": False,
    "top": False,
    "holds": False,
    "commits": False,
    "credit": 0.0,
    "confidence": 0.0,
    "first": False,
    "probability": np.nan,
    "p_value": np.nan,
    "fit": np.nan,
}

_NOT_FORECAST = dict.fromkeys(("stated", "brier", "log", "size", "covers"), np.nan)
"""Of a diagnosis that failed, and where the library cannot answer."""

LEAST = 1e-6
"""Probability below which the log score counts no further: one bad trial must not decide it [-]."""


def trial_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return one row per trial.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        Truth (``effect``, ``sort``, ``kind``, ``level``, ``severity``, ``visibility``, ``left_visible``, ``visible``,
        ``baseline``, ``calibrated``, ``gap_percent``), answer (``verdict``, ``answered``, ``sets``,
        ``p_value``, ``fit`` of the best row), judgement (``right``, ``top``, ``holds``, ``commits``,
        ``credit`` of a class counted fairly), and what the probabilities say whatever the verdict:
        ``confidence`` of the most probable set, whether that is right (``first``), and the ``probability`` of
        the truth. Where the truth is in the library, or none: ``stated`` probability of the most probable set, its
        ``brier`` and ``log`` score -ln p [-], ``size`` of the smallest set of rows that holds 95 %, and whether that
        ``covers`` the truth.
    """
    rows = [_row(outcome) for outcome in outcomes]
    return pd.DataFrame(rows).set_index("trial")


def _row(outcome: Outcome) -> dict[str, Any]:
    truth, answer = outcome.truth, outcome.answer
    hidden = {
        "trial": outcome.index,
        "effect": label(truth.effects),
        "sort": sort_of(truth),
        "kind": truth.kind,
        "level": truth.level,
        "severity": truth.severity,
        "visibility": truth.visibility,
        "left_visible": np.nan if truth.left_visible is None else truth.left_visible,
        "faint": bool(truth.effects) and min(truth.visibility, *truth.beside, np.inf) < VISIBLE,
        "visible": is_visible(truth),
        "baseline": truth.baseline,
        "calibrated": truth.calibrated,
        "gap_percent": truth.gap_percent,
    }
    answered = _FAILED | _NOT_FORECAST if answer is None else _answered(answer, truth)
    return hidden | answered | {"seconds": outcome.seconds, "failure": outcome.failure or ""}


def is_visible(truth: Truth) -> bool:
    """Return whether the data show what is hidden: of several effects each beside the others.

    Of one that the library lacks, whether they show that it does.
    """
    enough = truth.left_visible is None or truth.left_visible >= LEFT_VISIBLE
    return min(truth.visibility, *truth.beside, np.inf) >= VISIBLE and enough


def _answered(answer: Answer, truth: Truth) -> dict[str, Any]:
    stated: Posterior = posterior(answer, truth)
    return {
        "verdict": answer.verdict,
        "answered": _label(answer, truth),
        "sets": len(answer.sets),
        "right": is_right(answer, truth),
        "top": top_is_right(answer, truth),
        "holds": holds(answer, truth),
        "commits": commits(answer),
        "credit": credit(answer, truth),
        "confidence": stated.confidence,
        "first": stated.first_is_right,
        "probability": stated.truth,
        "p_value": answer.p_value,
        "fit": answer.ranking[0].fit if answer.ranking else np.nan,
        **(_forecast(stated) if sort_of(truth) in ("effect", "pair", "none") else _NOT_FORECAST),
    }


def _forecast(stated: Posterior) -> dict[str, float]:
    size, covers = stated.credible()
    return {
        "stated": float(stated.probability[0]),
        "brier": stated.brier,
        "log": -float(np.log(max(stated.truth, LEAST))),
        "size": float(size),
        "covers": float(covers),
    }


def _label(answer: Answer, truth: Truth) -> str:
    if answer.verdict == "named":
        return label(answer.sets[0]) if answer.sets else "named nothing"
    if answer.verdict == "class":
        return "class with it" if holds(answer, truth) else "class without it"
    return answer.verdict


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
