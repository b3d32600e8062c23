"""One table row per trial: what was hidden beside what was said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.answer import Answer
from modalkit.blind.run import BlindResult, Outcome
from modalkit.blind.trial import Truth

VISIBLE = 3.0
"""Standard deviations from which an effect is expected to be seen [-]."""


def trial_table(result: BlindResult) -> pd.DataFrame:
    """Return one row per trial.

    Parameters
    ----------
    result : BlindResult
        Outcome of a run.

    Returns
    -------
    pandas.DataFrame
        Truth (``effect``, ``known``, ``level``, ``visibility``), answer (``answered``, ``verdict``,
        ``candidates``) and judgement (``right``, ``top``, ``holds``, ``probability``).
    """
    rows = [_row(outcome) for outcome in result.outcomes]
    return pd.DataFrame(rows).set_index("trial")


def _row(outcome: Outcome) -> dict[str, Any]:
    truth, answer = outcome.truth, outcome.answer
    return {
        "trial": outcome.index,
        "effect": truth.effect,
        "known": truth.in_library,
        "level": truth.level,
        "visibility": truth.visibility,
        "visible": truth.visibility >= VISIBLE,
        "verdict": "failed" if answer is None else answer.verdict,
        "answered": _label(answer, truth),
        "candidates": 0 if answer is None else len(answer.sets),
        "right": answer is not None and is_right(answer, truth),
        "top": answer is not None and top_is_right(answer, truth),
        "holds": answer is not None and holds_truth(answer, truth),
        "probability": np.nan if answer is None else answer.probability(truth.accepted),
        "closed_percent": np.nan if answer is None or answer.closed is None else answer.closed,
        "seconds": outcome.seconds,
        "failure": outcome.failure or "",
    }


def _label(answer: Answer | None, truth: Truth) -> str:
    if answer is None:
        return "failed"
    if answer.verdict == "named":
        return "+".join(sorted(answer.sets[0])) if answer.sets else "named nothing"
    if answer.verdict == "class":
        return "class with it" if holds_truth(answer, truth) else "class without it"
    return answer.verdict


def holds_truth(answer: Answer, truth: Truth) -> bool:
    """Tell whether a named effect or a class contains the hidden one, alone and not as part of a pair."""
    if answer.verdict not in ("named", "class"):
        return False
    return any(len(s) == 1 and next(iter(s)) in truth.accepted for s in answer.sets)


def is_right(answer: Answer, truth: Truth) -> bool:
    """Tell whether the answer is true: effect named or in the class, none for none, unknown for withheld."""
    if truth.effect == "none":
        return answer.verdict == "none"
    if not truth.in_library:
        return answer.verdict == "unknown"
    return holds_truth(answer, truth)


def top_is_right(answer: Answer, truth: Truth) -> bool:
    """Tell whether the most probable single answer is the truth."""
    if truth.effect == "none" or not truth.in_library:
        return is_right(answer, truth)
    top = answer.top
    return top is not None and len(top) == 1 and next(iter(top)) in truth.accepted


_NOT_SCORED = ("local_stiffness.x", "local_stiffness.extent", "local_stiffness.loss")


def severity_table(result: BlindResult) -> pd.DataFrame:
    """Return one row per parameter of an effect that was rightly named or held by a class.

    Parameters
    ----------
    result : BlindResult
        Outcome of a run.

    Returns
    -------
    pandas.DataFrame
        ``true``, ``value``, ``low95``, ``high95`` [SI], ``covered`` and ``error`` relative to the true value.
        Of a local loss of stiffness only the compliance is scored, which is what data determine.
    """
    columns = ["trial", "parameter", "true", "value", "low95", "high95", "covered", "error"]
    rows = []
    for outcome in result.outcomes:
        answer = outcome.answer
        if answer is None or not holds_truth(answer, outcome.truth):
            continue
        for name, true in outcome.truth.parameters.items():
            if name in _NOT_SCORED or name not in answer.parameters:
                continue
            said = answer.parameters[name]
            covered = said.low <= true <= said.high
            rows.append(
                [outcome.index, name, true, said.value, said.low, said.high, covered, said.value / true - 1]
            )
    return pd.DataFrame(rows, columns=columns)


def place_table(result: BlindResult) -> pd.DataFrame:
    """Return one row per trial whose effect sits at a place, where the diagnosis gave one.

    Parameters
    ----------
    result : BlindResult
        Outcome of a run.

    Returns
    -------
    pandas.DataFrame
        ``true`` and nearest stated place ``said`` [m], ``error`` over the length of the beam [-], and how
        many ``places`` were offered. Effects that the library does not have are included.
    """
    columns = ["trial", "effect", "true", "said", "places", "error"]
    rows = []
    for outcome in result.outcomes:
        truth, answer = outcome.truth, outcome.answer
        true = truth.parameters.get(f"{truth.effect}.x")
        if true is None or answer is None or not answer.locations:
            continue
        said = min(answer.locations, key=lambda x: abs(x - true))
        error = abs(said - true) / truth.length
        rows.append([outcome.index, truth.effect, true, said, len(answer.locations), error])
    return pd.DataFrame(rows, columns=columns)
