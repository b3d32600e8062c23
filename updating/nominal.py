"""The nominal model of a case: what its study states, with the effects it has accepted."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from updating.case import Case
from updating.effects import accepted_state
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.prediction.stretch import is_placed


def predictor_of(case: Case) -> Predictor:
    """Return the nominal model of a case with the accepted effects, on the theory they ask for."""
    predictor = Predictor(case.spec, case.measured, case.environment, accepted_additions(case.accepted))
    theory = predictor.base.theory
    if theory is None or theory == case.spec.theory:
        return predictor
    return predictor.of(case.spec.with_theory(theory))


def accepted_additions(
    accepted: Iterable[tuple[str, Mapping[str, float]]],
) -> tuple[Callable[[Predictor], State], ...]:
    """Return what puts accepted effects, each a name and its values, into a predictor's model.

    Those with a place come last: it is one on the structure that the others have stretched.
    """
    ordered = sorted(accepted, key=lambda entry: is_placed(entry[1]))
    return tuple(_accepted(name, values) for name, values in ordered)


def _accepted(name: str, values: Mapping[str, float]) -> Callable[[Predictor], State]:
    return lambda predictor: accepted_state(predictor, name, values)
