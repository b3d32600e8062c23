"""The score of a blind run: how often it is right, when it commits, what it confuses, and whether it knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from acquisition.errors import InputError
from modalkit.blind.outcome import Outcome
from modalkit.blind.run import BlindResult
from modalkit.blind.scoring.abstention import Abstention, abstention
from modalkit.blind.scoring.calibration import (
    calibration_table,
    forecast_table,
    reliability_table,
    uniformity_table,
)
from modalkit.blind.scoring.closing import closing_summary, closing_table
from modalkit.blind.scoring.confusion import answer_table, confusion_matrix
from modalkit.blind.scoring.cover import cover_table
from modalkit.blind.scoring.document import nested, numbers, outcome_documents, table_rows
from modalkit.blind.scoring.headline import headline
from modalkit.blind.scoring.open_set import OpenSet, open_set
from modalkit.blind.scoring.places import channel_table, place_summary, place_table
from modalkit.blind.scoring.rates import asked, effect_table, group_table, rates
from modalkit.blind.scoring.severity import point_table, severity_summary, severity_table
from modalkit.blind.scoring.trials import trial_table

SCHEMA = "modalkit.blind/1"


@dataclass(frozen=True, eq=False)
class Score:
    """Tables of a blind run; every share with ``count``, ``total`` and a 95 % interval.

    Parameters
    ----------
    result : BlindResult
        What was scored.
    trials : pandas.DataFrame
        One row per trial.
    headline : pandas.DataFrame
        The numbers to read first.
    rates : pandas.DataFrame
        How often, by question.
    groups : pandas.DataFrame
        The same by level, kind of structure, baseline and absolute level.
    effects : pandas.DataFrame
        By hidden effect.
    answers : pandas.DataFrame
        Every answer in shares of a trial, and whether it is true.
    confusion : pandas.DataFrame
        Hidden effect against answer, classes counted by their shares [trials].
    abstention, abstention_outside : Abstention
        What is answered against how often it is right, without and with effects that cannot be known.
    forecasts : pandas.DataFrame
        What each trial forecast.
    calibration, reliability, uniformity : pandas.DataFrame
        Scores of the probabilities; stated against true, by bin; and the p-value where nothing is hidden.
    cover : pandas.DataFrame
        Coverage and size of the 95 % set.
    open_set : OpenSet
        Effects outside the library or left out of it.
    severity, severity_summary, points : pandas.DataFrame
        Errors of parameters, one by one and by parameter; lists of points.
    places, place_summary, channels : pandas.DataFrame
        Errors of places, one by one and by effect; the channel.
    closing, closing_summary : pandas.DataFrame
        Shrinkage said and true, one by one and in the mean.
    """

    result: BlindResult
    trials: pd.DataFrame
    headline: pd.DataFrame
    rates: pd.DataFrame
    groups: pd.DataFrame
    effects: pd.DataFrame
    answers: pd.DataFrame
    confusion: pd.DataFrame
    abstention: Abstention
    abstention_outside: Abstention
    forecasts: pd.DataFrame
    calibration: pd.DataFrame
    reliability: pd.DataFrame
    uniformity: pd.DataFrame
    cover: pd.DataFrame
    open_set: OpenSet
    severity: pd.DataFrame
    severity_summary: pd.DataFrame
    points: pd.DataFrame
    places: pd.DataFrame
    place_summary: pd.DataFrame
    channels: pd.DataFrame
    closing: pd.DataFrame
    closing_summary: pd.DataFrame

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return self.result.seed

    def to_json(self) -> dict[str, Any]:
        """Return everything as JSON can carry it; what is not a number becomes null."""
        tables = (
            *("headline", "rates", "groups", "effects", "calibration", "reliability", "uniformity", "cover"),
            *("severity", "severity_summary", "points", "places", "place_summary", "channels"),
            *("closing", "closing_summary"),
        )
        return {
            "schema": SCHEMA,
            "seed": self.seed,
            "plan": self.result.plan.to_json(),
            **{name: table_rows(getattr(self, name)) for name in tables},
            "confusion": nested(self.confusion),
            "abstention": _curve(self.abstention),
            "abstention_outside": _curve(self.abstention_outside),
            "open_set": {
                "effects": table_rows(self.open_set.effects),
                "area": numbers(self.open_set.area),
                "roc": table_rows(self.open_set.roc),
            },
            "trials": table_rows(
                self.trials.drop(columns="seconds").join(self.forecasts[["brier", "log", "size"]])
            ),
            "outcomes": outcome_documents(self.result.outcomes),
        }


def _curve(part: Abstention) -> dict[str, Any]:
    return {"area": numbers(part.area), "rule": numbers(part.rule), "curve": table_rows(part.curve)}


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
    rng = np.random.default_rng(result.seed)
    trials = trial_table(outcomes)
    answers, forecasts = answer_table(outcomes), forecast_table(outcomes, trials)
    severity, places, closing = severity_table(outcomes), place_table(outcomes), closing_table(outcomes)
    counted = rates(trials)
    sure = forecasts[asked(trials).loc[forecasts.index]]
    return Score(
        result=result,
        trials=trials,
        headline=headline(counted, trials, forecasts, severity, places),
        rates=counted,
        groups=group_table(trials),
        effects=effect_table(trials),
        answers=answers,
        confusion=confusion_matrix(answers),
        abstention=abstention(trials, rng),
        abstention_outside=abstention(trials, rng, outside=True),
        forecasts=forecasts,
        calibration=calibration_table(forecasts, trials, rng),
        reliability=reliability_table(sure["stated"].to_numpy(float), sure["right"].to_numpy(float)),
        uniformity=uniformity_table(trials),
        cover=cover_table(forecasts, trials, rng),
        open_set=open_set(trials, rng),
        severity=severity,
        severity_summary=severity_summary(severity, rng),
        points=point_table(outcomes),
        places=places,
        place_summary=place_summary(places, rng),
        channels=channel_table(outcomes, trials),
        closing=closing,
        closing_summary=closing_summary(closing, rng),
    )


def score_again(document: dict[str, Any]) -> Score:
    """Score a run again from the JSON of its score.

    Parameters
    ----------
    document : dict
        As :meth:`Score.to_json` returns it.

    Returns
    -------
    Score

    Raises
    ------
    InputError
        If it is not the score of a blind run.
    """
    if document.get("schema") != SCHEMA or "outcomes" not in document:
        raise InputError(f"schema {document.get('schema')!r} is not {SCHEMA}; give what `blind --json` wrote")
    from modalkit.simulator.drawing.ranges import DrawRanges

    outcomes = tuple(Outcome.from_json(row) for row in document["outcomes"])
    return score(BlindResult(document["seed"], DrawRanges.from_json(document["plan"]), outcomes))
