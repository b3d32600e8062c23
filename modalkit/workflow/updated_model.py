"""The model of a study after an update, to be compared with its test."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from updating import Case
from updating.models.state import State
from updating.nominal import predictor_of
from updating.prediction.predict import Predictor
from updating.update import Update
from updating.update.estimate import Estimate
from updating.update.parameters.named import build_parameter_set
from updating.update.parameters.parameters import ModelParameter


def updated_predictor(result: Update, case: Case) -> Predictor:
    """Return the model of a case with the parameters that an update found.

    Effects of the study that were updated stand in it once, at their new values.

    Parameters
    ----------
    result : Update
        By frequencies or by FRFs, of this case or of several with it.
    case : Case
        Test beside model.
    """
    own = _own(result.parameters, case.title)
    accepted = {name: dict(values) for name, values in case.accepted}
    nominal = predictor_of(case)
    found = build_parameter_set([p.name for p in own], nominal, case.tolerances, accepted)
    by_name = {p.name: p for p in own}
    values = [_value(by_name[p.name], p) for p in found.model_parameters]
    updated = {p.effect for p in found.model_parameters if p.effect}
    kept = tuple((name, given) for name, given in case.accepted if name not in updated)
    predictor = nominal if len(kept) == len(case.accepted) else predictor_of(replace(case, accepted=kept))

    def change(of: Predictor) -> State:
        return found.state(of, values)

    return predictor.for_test(predictor.measured, (*predictor.additions, change))


def _value(found: Estimate, parameter: ModelParameter) -> float:
    """Return a factor, or a value, as the model takes it; a shared factor multiplies what each study states."""
    if parameter.is_factor and found.factor is not None:
        return found.factor
    return found.value / parameter.nominal


def _own(parameters: Sequence[Estimate], title: str) -> list[Estimate]:
    """Return the parameters of one study: its own, and those that it shares."""
    return [p for p in parameters if p.study in (None, title)]
