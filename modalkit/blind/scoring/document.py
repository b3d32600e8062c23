"""The score as JSON, with everything of every trial: it can be scored again from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.outcome import Outcome


def table_rows(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return a table as a list of rows; what is not a number becomes null."""
    named = table.index.name is not None
    rows = (table.reset_index() if named else table).to_dict(orient="records")
    return [{str(key): _plain(value) for key, value in row.items()} for row in rows]


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def outcome_documents(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Return truth, answer and seal of every trial; not the time it took, which is no part of the result."""
    return [_outcome(outcome) for outcome in outcomes]


def _outcome(outcome: Outcome) -> dict[str, Any]:
    slim = None if outcome.answer is None else outcome.answer.to_json()
    whole = replace(outcome, document=slim, seconds=0.0).to_json()
    return whole | {"commitment": outcome.sealed.commitment}


def nested(answers: pd.DataFrame) -> dict[str, dict[str, float]]:
    """Return hidden effect, then answer: trials, a class counted by the shares of its sets."""
    found: dict[str, dict[str, float]] = {}
    summed = answers.groupby(["hidden", "answer"], as_index=False)["share"].sum()
    for hidden, answer, value in summed.itertuples(index=False):
        found.setdefault(hidden, {})[answer] = value
    return found
