"""From cases to the problem that is solved: specimens with their parameters, unknowns, weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.case import Case
from updating.models import build_structure
from updating.models.deck_states import deck_answers
from updating.models.structure import FieldStructure
from updating.nominal import predictor_of
from updating.prediction.matching import pair_modes
from updating.prediction.predict import Predictor
from updating.update.data.nominal import Nominal, UpdatedModel
from updating.update.data.specimen import Specimen
from updating.update.data.system import Quantity, System, Weights
from updating.update.parameters.affine import eligible
from updating.update.parameters.basis import extended, update_basis
from updating.update.parameters.named import build_parameter_set
from updating.update.parameters.parameters import ModelParameter, ParameterSet

BEYOND = ("shapes", "constants")
"""What can be data beside the frequencies."""


def build_specimen(
    case: Case, parameters: Sequence[str], *, lean: bool = False, level: bool = False
) -> Specimen:
    """Pair the modes of a case and find its parameters.

    Parameters
    ----------
    case : Case
        Test beside model.
    parameters : sequence of str
        What is to be turned.
    lean : bool
        Whether a basis made for these parameters will do, without static answers at the test's points: for
        frequencies and shapes, not for FRFs.
    level : bool
        Whether measured constants are data with their level, not up to a factor per mode.

    Raises
    ------
    StudyError
        If a parameter does not exist on this specimen.
    EstimationError
        If no measured mode has a partner in the model.
    """
    predictor = predictor_of(case)
    accepted = {name: dict(values) for name, values in case.accepted}
    parameter_set = build_parameter_set(parameters, predictor, case.tolerances, accepted)
    _check_data(parameter_set, lean=lean)
    predictor = _on_own_basis(predictor, parameter_set) if lean else predictor
    paired = pair_modes(case.measured, predictor.predict())
    number = 1 + paired.rows
    predictor = _without_updated(case, parameter_set, predictor)
    model = UpdatedModel(predictor.for_test(paired.measured), parameter_set)
    return Specimen(
        title=case.title,
        model=model,
        nominal=Nominal(model, paired.measured, paired.order, level),
        measured=paired.measured,
        number=number,
        order=paired.order,
        warnings=(*case.measured.warnings, *paired.warnings),
        correction=np.ones(len(number)),
    )


def _check_data(parameter_set: ParameterSet, *, lean: bool) -> None:
    """Refuse parameters on which the data do not depend."""
    dampers = [
        model_parameter.name
        for model_parameter in parameter_set.model_parameters
        if model_parameter.damper is not None
    ]
    if lean and dampers:
        raise StudyError(
            f"update: {dampers[0]} is a coefficient of damping, which does not change frequencies; use "
            'method = "frf"'
        )
    numbers = [p.name for p in parameter_set.model_parameters if p.of_deck is not None]
    if numbers and not lean:
        raise StudyError(
            f"update: {numbers[0]} is a number of a deck, which is updated by frequencies and shapes only; use "
            'method = "eigenvalue"'
        )


def _without_updated(case: Case, parameter_set: ParameterSet, predictor: Predictor) -> Predictor:
    """Return the predictor without those of the accepted effects that are updated, on a basis of its own."""
    updated = {model_parameter.effect for model_parameter in parameter_set.model_parameters}
    names = [name for name, _ in case.accepted]
    if twice := sorted(name for name in updated if names.count(name) > 1):
        raise StudyError(
            f"update: {twice[0]} is given {names.count(twice[0])} times in [[model.effect]], so that the name "
            "does not state which is meant; keep one"
        )
    if not updated & set(names):
        return predictor
    kept = tuple((n, v) for n, v in case.accepted if n not in updated)
    return predictor_of(replace(case, accepted=kept))


def _on_own_basis(predictor: Predictor, parameter_set: ParameterSet) -> Predictor:
    """Give a plain model whose parameters are factors a basis made for these; others keep theirs.

    The basis of a deck gets what it becomes where its numbers are turned.
    """
    numbers = [p.of_deck for p in parameter_set.model_parameters if p.of_deck is not None]
    if numbers and predictor.reduced.basis.shape[1] < predictor.reduced.structure.n_dofs:
        answers = np.hstack([deck_answers(predictor.reduced, number) for number in numbers])
        return predictor.on(extended(predictor.reduced, answers))
    if (
        predictor.additions
        or not eligible(parameter_set.model_parameters)
        or predictor.spec.kind not in ("beam", "plate")
    ):
        return predictor
    structure = build_structure(predictor.spec)
    if not isinstance(structure, FieldStructure):
        return predictor
    test = predictor.measured
    highest, count = float(test.frequency.max()), len(test.frequency)
    return predictor.on(update_basis(structure, parameter_set.model_parameters, highest=highest, count=count))


def build_system(
    specimens: Sequence[Specimen],
    shared: Sequence[str],
    weights: Weights,
    quantity: Quantity,
    all_modes: Sequence[int],
    *,
    regularised: bool,
    shapes: bool = False,
) -> System:
    """Number the unknowns and lay out the weights.

    Raises
    ------
    StudyError
        If a shared name is no parameter, weights do not fit the modes, or there are more free parameters than
        data.
    """
    known = {model_parameter.name for s in specimens for model_parameter in s.parameter_set.model_parameters}
    if missing := sorted(set(shared) - known):
        raise StudyError(
            f"update: shared parameter {missing[0]!r} is updated in no study; add it to the parameters"
        )
    unknowns: dict[tuple[str, int], ModelParameter] = {}
    index = []
    for i, specimen in enumerate(specimens):
        keys = [(k.name, -1 if k.name in shared else i) for k in specimen.parameter_set.model_parameters]
        for key, model_parameter in zip(keys, specimen.parameter_set.model_parameters, strict=True):
            unknowns.setdefault(key, model_parameter)
        index.append([list(unknowns).index(key) for key in keys])
    system = System(
        tuple(specimens),
        tuple(np.array(i) for i in index),
        tuple(unknowns.values()),
        tuple(owner for _, owner in unknowns),
        _weights(specimens, weights, all_modes),
        quantity,
        regularised,
        shapes=shapes,
    )
    free = int(np.sum(system.prior == 0))
    if free > system.count:
        raise StudyError(
            f"update: {free} parameters without a tolerance but only {system.count} frequencies; name fewer "
            'parameters, or use weights = "covariance" with [tolerances]'
        )
    return system


def _weights(
    specimens: Sequence[Specimen], weights: Weights, all_modes: Sequence[int]
) -> tuple[FloatArray, ...]:
    """Return W_s for relative frequencies of each specimen."""
    if isinstance(weights, str):
        if weights == "covariance":
            return tuple(1 / s.relative_variance for s in specimens)
        if weights == "relative":
            return tuple(np.ones(len(s.number)) for s in specimens)
        if weights != "eigenvalue":
            raise StudyError(
                f"update: unknown weights {weights!r}; use covariance, relative, eigenvalue or a list of numbers"
            )
        top = max(s.measured.frequency.max() for s in specimens)
        return tuple((s.measured.frequency / top) ** 4 for s in specimens)
    given = np.asarray(weights, dtype=float)
    if len(given) != sum(all_modes) or not np.all(given >= 0) or not np.any(given > 0):
        raise StudyError(
            f"update: {len(given)} weights for {sum(all_modes)} measured modes; give one for each, none negative, "
            "in the order of the tests and their frequencies"
        )
    parts = np.split(given, np.cumsum(all_modes)[:-1])
    return tuple(part[s.number - 1] for part, s in zip(parts, specimens, strict=True))


def per_case(parameters: Sequence[str] | Sequence[Sequence[str]], count: int) -> list[list[str]]:
    """Return the parameters of each case."""
    if not parameters:
        raise StudyError('update: no parameters; name some, for instance parameters = ["E"]')
    if all(isinstance(p, str) for p in parameters):
        return [[str(p) for p in parameters]] * count
    if len(parameters) != count:
        raise StudyError(
            f"update: {len(parameters)} lists of parameters for {count} studies; give one for each"
        )
    return [list(own) for own in parameters]


def check_data(data: Sequence[str], cases: Sequence[Case], weights: Weights) -> None:
    """See that what is to be data exists and can be weighted."""
    if unknown := sorted(set(data) - {"frequencies", *BEYOND}) or "frequencies" not in data:
        found = ", ".join(unknown) if isinstance(unknown, list) else "no frequencies"
        raise StudyError(
            f'update: data: {found}; use ["frequencies"], with "shapes" or "constants" where wanted'
        )
    for name in (n for n in BEYOND if n in data):
        if weights != "covariance":
            raise StudyError(
                f'update: {name} as data are weighted by their variances; use weights = "covariance"'
            )
        if not any(case.measured.has_shapes for case in cases):
            raise StudyError(f"update: {cases[0].title}: no shapes were measured; leave data at frequencies")
    bare = [c.title for c in cases if c.measured.has_shapes and not c.measured.absolute]
    if "constants" in data and bare:
        raise StudyError(
            f"update: {bare[0]}: shapes are known, but not their level; constants as data need "
            'FRFs or mass-normalised shapes, use "shapes"'
        )
