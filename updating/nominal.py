"""The nominal model of a case: what its study says, with the effects it has accepted."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from updating.case import Case
from updating.effects import accepted_state
from updating.models.state import State
from updating.prediction.predict import Predictor


def predictor_of(case: Case) -> Predictor:
    """Return the nominal model of a case with the accepted effects, on the theory they ask for."""
    additions = tuple(_accepted(name, values) for name, values in case.accepted)
    predictor = Predictor(case.spec, case.measured, case.environment, additions)
    theory = predictor.base.theory
    return predictor if theory is None else predictor.under(theory)


def _accepted(name: str, values: Mapping[str, float]) -> Callable[[Predictor], State]:
    return lambda predictor: accepted_state(predictor, name, values)
