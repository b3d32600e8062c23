"""The forecast as JSON can carry it."""

from __future__ import annotations

import math
from typing import Any

from modalkit.output.schemas.plan import AdviceEntry, DesignEntry, PlanDocument
from modalkit.planning.family import Family
from modalkit.planning.forecast import Advice, DesignForecast, Forecast


def to_json(found: Forecast) -> PlanDocument:
    """Return a forecast as JSON.

    Parameters
    ----------
    found : Forecast
        What was found.

    Returns
    -------
    dict
        ``null`` stands for a severity that is never told.
    """
    return {
        "schema": "modalkit.plan/1",
        "said": list(found.bench.statement),
        "left_out": list(found.bench.left_out),
        "not_forecast": list(found.bench.not_forecast),
        "now": _design_forecast(found.now),
        "advice": [_advice(one) for one in found.advice],
    }


def _design_forecast(evaluation: DesignForecast) -> DesignEntry:
    matrix = evaluation.matrix
    return {
        "effects": [
            {
                "effect": family_of(evaluation, name).cause,
                "name": name,
                "at": family_of(evaluation, name).at or None,
                "outcome": evaluation.outcomes[name].kind,
                "not_told_from": list(evaluation.outcomes[name].rivals),
                "seen_from": statement(evaluation, name, limit.seen),
                "separated_from": statement(evaluation, name, limit.separated),
                "sure_from": statement(evaluation, name, limit.sure),
                "sure": _number(limit.sure),
                "seen": _number(limit.seen),
                "separated": _number(limit.separated),
                "asked": statement(evaluation, name, limit.clear),
                "nearest": limit.nearest,
                "nearest_sigma": _number(limit.sigma),
                "sigma": {str(rival): _number(value) for rival, value in matrix.loc[name].items()},
            }
            for name, limit in evaluation.limits.items()
        ],
        "classes": [list(group) for group in evaluation.classes],
        "unseen": list(evaluation.unseen),
        "separated_share": evaluation.separated_share,
    }


def _advice(one: Advice) -> AdviceEntry:
    return {
        "change": one.change.key,
        "measure": one.change.measure,
        "worth": one.worth,
        "threshold_factor": one.factor,
        "separates": [list(pair) for pair in one.separates],
        "then": _design_forecast(one.after),
    }


def statement(evaluation: DesignForecast, name: str, q: float) -> str | None:
    """Return a severity in words; None where there is none that is told."""
    return family_of(evaluation, name).say(q) if math.isfinite(q) else None


def family_of(evaluation: DesignForecast, name: str) -> Family:
    """Return the family of an effect."""
    return evaluation.found[evaluation.names.index(name)].curve.family


def _number(value: Any) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None
