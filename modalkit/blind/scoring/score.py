"""The score of a blind run: how often it is right, when it commits, what it confuses, and whether its confidence is
justified.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from acquisition.errors import InputError
from modalkit.blind.outcome import Outcome
from modalkit.blind.run import BlindResult
from modalkit.blind.scoring import abstention as waiting
from modalkit.blind.scoring.calibration import calibration, cover, uniformity
from modalkit.blind.scoring.closing import closing, closing_table
from modalkit.blind.scoring.document import nested, outcome_documents, table_rows
from modalkit.blind.scoring.levels import level_rates
from modalkit.blind.scoring.open_set import open_set
from modalkit.blind.scoring.places import channel_rates, place_errors, place_table
from modalkit.blind.scoring.rates import rates, rates_by_effect, rates_by_group
from modalkit.blind.scoring.severity import point_table, severity, severity_table
from modalkit.blind.scoring.table import Rate, Rates
from modalkit.blind.scoring.trials import answer_table, trial_table

SCHEMA, EARLIER = "modalkit.blind/2", "modalkit.blind/1"
"""Of version 1 there are files, too: they hold the same trials, which is all that is read of them."""


@dataclass(frozen=True, eq=False)
class Score:
    """What a blind run states: one table of all questions, and what it is counted from.

    Parameters
    ----------
    result : BlindResult
        What was scored.
    rates : Rates
        Every question, of every group of trials that it is asked of.
    trials : pandas.DataFrame
        One row per trial.
    answers : pandas.DataFrame
        Every answer in shares of a trial, and whether it is true.
    severity, points : pandas.DataFrame
        Errors of parameters, one by one; lists of points.
    places : pandas.DataFrame
        Errors of places, one by one.
    closing : pandas.DataFrame
        Stated and true shrinkage, one by one.
    """

    result: BlindResult
    rates: Rates
    trials: pd.DataFrame
    answers: pd.DataFrame
    severity: pd.DataFrame
    points: pd.DataFrame
    places: pd.DataFrame
    closing: pd.DataFrame

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return self.result.seed

    def to_json(self) -> dict[str, Any]:
        """Return everything as JSON can carry it; what is not a number becomes null."""
        return {
            "schema": SCHEMA,
            "seed": self.seed,
            "plan": self.result.plan.to_json(),
            "rates": table_rows(self.rates.frame()),
            **{name: table_rows(getattr(self, name)) for name in ("severity", "points", "places", "closing")},
            "confusion": nested(self.answers),
            "trials": table_rows(self.trials.drop(columns="seconds")),
            "outcomes": outcome_documents(self.result.outcomes),
        }


def score(result: BlindResult) -> Score:
    """Score a blind run.

    Parameters
    ----------
    result : BlindResult
        Outcome of a run; its seed also draws the bootstrap samples of the intervals.

    Returns
    -------
    Score
        A diagnosis that failed counts as wrong in every rate over all trials, and as no commitment.

    Raises
    ------
    InputError
        If there are no trials.
    """
    outcomes = result.outcomes
    if not outcomes:
        raise InputError("the blind run has no trials to score; run at least one")
    trials = trial_table(outcomes)
    parameters, points = severity_table(outcomes), point_table(outcomes)
    places, closed = place_table(outcomes), closing_table(outcomes)

    def asked() -> Iterator[Rate]:
        rng = np.random.default_rng(result.seed)
        yield from rates(trials)
        yield from rates_by_group(trials)
        yield from rates_by_effect(trials)
        yield from channel_rates(outcomes, trials)
        yield from level_rates(outcomes, trials)
        yield from waiting.abstention(trials, waiting.KNOWN, rng)
        yield from waiting.abstention(trials, waiting.BOTH, rng)
        yield from calibration(trials, rng)
        yield from uniformity(trials)
        yield from cover(trials, rng)
        yield from open_set(trials, rng)
        yield from severity(parameters, points, rng)
        yield from place_errors(places, rng)
        yield from closing(closed, rng)

    return Score(
        result=result,
        rates=Rates(tuple(asked())),
        trials=trials,
        answers=answer_table(outcomes),
        severity=parameters,
        points=points,
        places=places,
        closing=closed,
    )


def score_again(document: dict[str, Any]) -> Score:
    """Score a run again from the JSON of its score.

    Parameters
    ----------
    document : dict
        As :meth:`Score.to_json` returns it, or an earlier version.

    Returns
    -------
    Score

    Raises
    ------
    InputError
        If it is not the score of a blind run.
    """
    schema = str(document.get("schema"))
    if schema not in (SCHEMA, EARLIER) or "outcomes" not in document:
        raise InputError(
            f"schema {schema!r} is neither {SCHEMA} nor {EARLIER}; give a file written by `blind --json`"
        )
    from modalkit.simulator.drawing.ranges import DrawRanges

    outcomes = tuple(Outcome.from_json(row) for row in document["outcomes"])
    return score(BlindResult(document["seed"], DrawRanges.from_json(document["plan"]), outcomes))
