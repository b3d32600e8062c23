"""The score of a blind run: how often it is right, when it commits, what it confuses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import scipy.stats

from modalkit.blind.run import BlindResult
from modalkit.blind.scoring.rows import place_table, severity_table, trial_table

SCHEMA = "modalkit.blind/1"


@dataclass(frozen=True, eq=False)
class Score:
    """Tables of a blind run.

    Parameters
    ----------
    seed : int
        Of the run.
    trials : pandas.DataFrame
        One row per trial.
    rates : pandas.DataFrame
        ``count`` of ``total``, ``rate`` and its 95 % Wilson interval ``low95``, ``high95``, by question.
    confusion : pandas.DataFrame
        Hidden effect against what was answered.
    effects : pandas.DataFrame
        By hidden effect: how often right, named, held by a class, unknown, none, failed; mean number of
        sets in an answer.
    severity, places : pandas.DataFrame
        Errors of parameters and of places.
    seals : pandas.DataFrame
        Commitment and salt of every trial.
    """

    seed: int
    trials: pd.DataFrame
    rates: pd.DataFrame
    confusion: pd.DataFrame
    effects: pd.DataFrame
    severity: pd.DataFrame
    places: pd.DataFrame
    seals: pd.DataFrame

    def to_json(self) -> dict[str, Any]:
        """Return everything as JSON can carry it; what is not a number becomes null."""
        return {
            "schema": SCHEMA,
            "seed": self.seed,
            "rates": _records(self.rates),
            "confusion": {
                str(effect): {str(k): int(v) for k, v in row.items() if v}
                for effect, row in self.confusion.iterrows()
            },
            "effects": _records(self.effects),
            "severity": _records(self.severity),
            "places": _records(self.places),
            "trials": _records(self.trials.drop(columns="seconds")),
            "seals": _records(self.seals),
        }


def score(result: BlindResult) -> Score:
    """Score a blind run.

    Parameters
    ----------
    result : BlindResult
        Outcome of a run.

    Returns
    -------
    Score
        A diagnosis that failed counts as wrong in every rate over all trials, and as no commitment.
    """
    trials = trial_table(result)
    severity = severity_table(result)
    seals = pd.DataFrame(
        {
            "commitment": [o.sealed.commitment for o in result.outcomes],
            "salt": [o.sealed.salt for o in result.outcomes],
            "statement": [o.sealed.statement for o in result.outcomes],
        },
        index=pd.Index([o.index for o in result.outcomes], name="trial"),
    )
    return Score(
        seed=result.seed,
        trials=trials,
        rates=_rates(trials, severity),
        confusion=pd.crosstab(trials["effect"], trials["answered"]),
        effects=_by_effect(trials),
        severity=severity,
        places=place_table(result),
        seals=seals,
    )


def wilson(count: int, total: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share.

    Parameters
    ----------
    count, total : int
        Hits, and trials.

    Returns
    -------
    low, high : float
        Bounds; nan where there are no trials [-].
    """
    if total == 0:
        return math.nan, math.nan
    interval = scipy.stats.binomtest(count, total).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def _rates(trials: pd.DataFrame, severity: pd.DataFrame) -> pd.DataFrame:
    none = trials["effect"] == "none"
    library = trials["known"] & ~none
    seen = trials["visible"]
    asked = (library & seen) | none
    withheld = ~trials["known"] & seen
    named, kind = trials["verdict"] == "named", trials["verdict"] == "class"
    true_name = named & trials["holds"]
    answers = named | kind
    questions: dict[str, tuple[pd.Series, pd.Series]] = {
        "most probable answer is the truth": (trials["top"], asked),
        "answer is true (named, in the class, or none)": (trials["right"], asked),
        "commits to a name": (named, library & seen),
        "right when it commits": (true_name, named),
        "right when it commits, effect of the library": (true_name, named & library & seen),
        "class holds the truth": (trials["holds"], kind & library & seen),
        "right when it names or gives a class": (trials["holds"], answers & library & seen),
        "visible effect called none": (trials["verdict"] == "none", library & seen),
        "visible effect called unknown": (trials["verdict"] == "unknown", library & seen),
        "faint effect: true answer or none": (
            trials["right"] | (trials["verdict"] == "none"),
            trials["known"] & ~none & ~seen,
        ),
        "false alarm on none": (~trials["right"], none),
        "withheld effect called unknown": (trials["verdict"] == "unknown", withheld),
        "withheld effect given a wrong name": (named, withheld),
        "severity inside its 95 % interval": (severity["covered"].astype(bool), severity["covered"].notna()),
        "diagnosis failed": (trials["verdict"] == "failed", trials["known"].notna()),
    }
    rows = {}
    for question, (hit, among) in questions.items():
        count, total = int((hit & among).sum()), int(among.sum())
        low, high = wilson(count, total)
        rows[question] = (count, total, count / total if total else math.nan, low, high)
    table = pd.DataFrame.from_dict(
        rows, orient="index", columns=["count", "total", "rate", "low95", "high95"]
    )
    table.index.name = "question"
    return table


def _by_effect(trials: pd.DataFrame) -> pd.DataFrame:
    answered = trials["verdict"].isin(["named", "class"])
    marks = pd.DataFrame(
        {
            "effect": trials["effect"],
            "trials": 1,
            "visible": trials["visible"],
            "right": trials["right"],
            "top": trials["top"],
            "named right": (trials["verdict"] == "named") & trials["holds"],
            "class with it": (trials["verdict"] == "class") & trials["holds"],
            "wrong": answered & ~trials["holds"],
            "unknown": trials["verdict"] == "unknown",
            "none": trials["verdict"] == "none",
            "failed": trials["verdict"] == "failed",
        }
    )
    table = marks.groupby("effect").sum().astype(int)
    size = trials["candidates"].where(answered).groupby(trials["effect"]).mean()
    return table.assign(**{"mean class size": size})


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    named = table.index.name is not None
    rows = (table.reset_index() if named else table).to_dict(orient="records")
    return [{str(key): _plain(value) for key, value in row.items()} for row in rows]


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
