"""The forecast as JSON can carry it."""

from __future__ import annotations

import math

from modalkit.output.fields import fill
from modalkit.output.schemas.plan import AdviceEntry, DesignEntry, ForecastEntry, PlanDocument
from modalkit.output.whole import plain
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
        ``null`` stands for a severity that is never separated.
    """
    return {
        "schema": "modalkit.plan/1",
        "said": list(found.bench.assumptions),
        "left_out": list(found.bench.left_out),
        "not_forecast": list(found.bench.not_forecast),
        "now": _design_forecast(found.now),
        "advice": [_advice(one) for one in found.advice],
    }


def _design_forecast(evaluation: DesignForecast) -> DesignEntry:
    return fill(DesignEntry, evaluation, effects=[_forecast(evaluation, name) for name in evaluation.limits])


def _forecast(evaluation: DesignForecast, name: str) -> ForecastEntry:
    limit, family, outcome = evaluation.limits[name], family_of(evaluation, name), evaluation.outcomes[name]
    return fill(
        ForecastEntry,
        {**vars(limit), **vars(outcome)},
        effect=family.cause,
        name=name,
        at=family.at or None,
        seen_from=severity_text(evaluation, name, limit.seen),
        separated_from=severity_text(evaluation, name, limit.separated),
        sure_from=severity_text(evaluation, name, limit.sure),
        asked=severity_text(evaluation, name, limit.clear),
        sigma=plain(evaluation.matrix.loc[name].to_dict()),
    )


def _advice(one: Advice) -> AdviceEntry:
    return fill(
        AdviceEntry, one, change=one.change.key, measure=one.change.measure, then=_design_forecast(one.after)
    )


def severity_text(evaluation: DesignForecast, name: str, q: float) -> str | None:
    """Return a severity in words; None where none is separated."""
    return family_of(evaluation, name).say(q) if math.isfinite(q) else None


def family_of(evaluation: DesignForecast, name: str) -> Family:
    """Return the family of an effect."""
    return evaluation.found[evaluation.names.index(name)].curve.family
