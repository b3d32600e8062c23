"""The parameters that names of a study file stand for: ``E``, ``root.E``, ``length``, ``sensor_mass``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from acquisition.errors import StudyError
from updating.effects import LIBRARY, Effect
from updating.models.imported.decks import KNOWN, DeckParameter
from updating.models.parts import Region
from updating.models.spec import Spec
from updating.prediction.predict import Predictor
from updating.tolerances import FACTOR_RANGE, Tolerances
from updating.update.parameters.parameters import ModelParameter, ParameterSet

UNITS = {"E": "Pa", "density": "kg/m^3", "thickness": "m", "width": "m"}
"""Properties that a factor of the whole structure can scale, and their units."""

REGIONAL = {"E": "Pa", "density": "kg/m^3", "thickness": "m", "area": "m^2", "inertia": "m^4"}
"""Properties that a factor of one region can scale, and their units; the last two of beams."""

DAMPERS = {"alpha": "1/s", "beta": "s", "loss_factor": "-"}
"""Coefficients of damping, of the whole or of one region, and their units."""

MIDDLING = 0.01
"""Damping ratio that sets the scale of the coefficients of damping [-]."""

MOST = 50.0
"""Upper bound of a coefficient of damping, in that scale [-]."""

UNTOLD = np.log(2.0)
"""1-sigma scale of the logarithm of a factor of which the study states no tolerance [-]."""


def only_damps(name: str) -> bool:
    """Return whether a parameter, as the user writes it, is a matter of damping alone."""
    effect, _, parameter = name.partition(".")
    if effect in LIBRARY:
        return LIBRARY[effect].damps(parameter)
    return name.rpartition(".")[2] in DAMPERS


def build_parameter_set(
    names: Sequence[str],
    predictor: Predictor,
    tolerances: Tolerances,
    fixed: Mapping[str, Mapping[str, float]],
) -> ParameterSet:
    """Find the parameters that names stand for.

    Parameters
    ----------
    names : sequence of str
        ``E``, ``density``, ``thickness``, ``width``, ``alpha``, ``beta``, ``loss_factor``; ``region.property``,
        where regions of one name are turned together; ``effect`` (all its parameters) or ``effect.parameter``.
    predictor : Predictor
        The specimen.
    tolerances : Tolerances
        The modeller's doubts.
    fixed : mapping
        Values of effects' parameters that are not updated.

    Raises
    ------
    StudyError
        If a name means nothing, is given twice, or cannot be examined on this specimen.
    """
    model_parameters: list[ModelParameter] = []
    for name in names:
        model_parameters += _model_parameters(name, predictor, tolerances)
    if not model_parameters:
        raise StudyError('update: no parameters; name some, for instance parameters = ["E"]')
    seen = [model_parameter.name for model_parameter in model_parameters]
    if twice := sorted({n for n in seen if seen.count(n) > 1}):
        raise StudyError(f"update: parameter {twice[0]!r} is given twice; name each once")
    parameter_set = ParameterSet(tuple(model_parameters), fixed)
    _check_complete(parameter_set, predictor)
    return parameter_set


def _check_complete(parameter_set: ParameterSet, predictor: Predictor) -> None:
    """See that every effect with a parameter has all its parameters."""
    for name, given in parameter_set.effects([k.start for k in parameter_set.model_parameters]).items():
        missing = {p.name for p in LIBRARY[name].parameters(predictor) if p.needed} - set(given)
        if missing:
            raise StudyError(
                f"update: {name} also needs {', '.join(sorted(missing))}; update them too or give their values in "
                f"[[model.effect]]"
            )


def _model_parameters(name: str, predictor: Predictor, tolerances: Tolerances) -> list[ModelParameter]:
    spec = predictor.spec
    head, _, tail = name.rpartition(".") if "." in name else (name, "", "")
    deck = None if spec.imported is None else spec.imported.deck
    places = tuple(i for i, region in enumerate(spec.regions) if region.name == head)
    if deck is not None and tail and head not in LIBRARY:
        if not places and tail in REGIONAL:
            places = deck.division.made_of(head)
        if (number := deck.parameter(name)) is not None:
            return [_number(number, tolerances)]
    if places and tail in DAMPERS:
        return [_bounded(_damper(name, tail, predictor, places), tolerances)]
    if places and tail:
        return [_regional(name, places, tail, spec, tolerances)]
    if name in DAMPERS:
        return [_bounded(_damper(name, name, predictor, ()), tolerances)]
    if head in UNITS and tail in ("", "factor"):
        return [_whole(head, spec, tolerances)]
    if head in LIBRARY:
        return _effect(name, LIBRARY[head], tail, predictor, tolerances)
    known = ", ".join([*UNITS, *DAMPERS, *(n for n in LIBRARY if n not in UNITS)])
    own = list(dict.fromkeys(region.name for region in spec.regions))
    raise StudyError(
        f"update: no parameter {name!r}; known are {known}, and region.E, region.density, region.thickness, "
        f"region.area, region.inertia, region.alpha ... with the regions {', '.join(own[:4])}"
        + ("..." if len(own) > 4 else "")
        + (f"; of the deck: MATERIAL.E, MATERIAL.density, {KNOWN}" if deck is not None else "")
    )


def _whole(name: str, spec: Spec, tolerances: Tolerances) -> ModelParameter:
    _check_scales(name, name, spec)
    nominal = {
        "E": spec.material.E,
        "density": spec.material.density,
        "thickness": spec.thickness,
        "width": spec.width,
    }[name]
    of_deck = spec.imported is not None and spec.imported.deck is not None
    every = tuple(range(len(spec.regions))) if of_deck else ()  # a deck's springs have no modulus
    found = _factor(name, _unit(UNITS[name], nominal, spec), nominal, tolerances.of(name, name), name, every)
    return _bounded(found, tolerances)


def _number(number: DeckParameter, tolerances: Tolerances) -> ModelParameter:
    """Return a number of a deck: a factor runs by its logarithm, a shift by itself."""
    general = "thickness" if number.kind.startswith("thickness") else ""
    tolerance = tolerances.of(number.name, general)
    width = UNTOLD if number.relative else (number.high - number.low) / np.sqrt(12)
    found = ModelParameter(
        name=number.name, unit=number.unit, nominal=number.nominal, start=number.start, low=number.low,
        high=number.high, doubt=float(tolerance or width),
        tolerated=tolerance > 0, log=number.relative, of_deck=number,
    )  # fmt: skip
    return _bounded(found, tolerances)


def _bounded(parameter: ModelParameter, tolerances: Tolerances) -> ModelParameter:
    """Give a parameter the bounds that the study states of it; without a tolerance it lies anywhere between them.

    Raises
    ------
    StudyError
        If they leave out where it starts, or reach where a deck cannot follow, or if a tolerance is stated of what
        has no nominal value.
    """
    if parameter.name in tolerances.parts and not parameter.tolerated:
        raise StudyError(
            f"[tolerances] {parameter.name} has no nominal value: the model holds no such effect or damping; give "
            "its bounds instead"
        )
    if parameter.name not in tolerances.bounds:
        return parameter
    low, high = tolerances.bounds[parameter.name]
    given = f"[{low:g}, {high:g}]"
    if not low <= parameter.start <= high or (parameter.log and low <= 0):
        kind = (
            "a factor, where 1 leaves the model as it is" if parameter.is_factor else f"in {parameter.unit}"
        )
        raise StudyError(
            f"[tolerances] bounds of {parameter.name}: {given} do not include the start value, {parameter.start:g} "
            f"({kind}); give bounds that do"
        )
    if parameter.of_deck is not None and (low < parameter.low or high > parameter.high):
        raise StudyError(
            f"[tolerances] bounds of {parameter.name}: {given} exceed [{parameter.low:g}, {parameter.high:g}], the "
            "range in which the deck is run; narrow them"
        )
    inside = replace(parameter, low=low, high=high)
    return inside if parameter.tolerated else replace(inside, doubt=inside.span() / np.sqrt(12))


def _regional(
    name: str, places: tuple[int, ...], prop: str, spec: Spec, tolerances: Tolerances
) -> ModelParameter:
    if prop not in REGIONAL or (prop in ("area", "inertia") and spec.kind != "beam"):
        choice = ", ".join(n for n in REGIONAL if spec.kind == "beam" or n not in ("area", "inertia"))
        raise StudyError(
            f"update: {name}: a region has no {prop!r} to update; use {choice}, {', '.join(DAMPERS)}"
        )
    _check_scales(name, prop, spec, regional=True)
    region = spec.regions[places[0]]
    own = getattr(region, prop)
    nominal = float(_general(prop, region, spec) if own is None else own)
    found = _factor(
        name, _unit(REGIONAL[prop], nominal, spec), nominal, tolerances.of(name, prop), prop, places
    )
    return _bounded(found, tolerances)


def _unit(unit: str, nominal: float, spec: Spec) -> str:
    """Return the unit of a property; a factor has none where no material of imported matrices is stated."""
    return "-" if spec.imported is not None and nominal == 1.0 else unit


def _check_scales(name: str, prop: str, spec: Spec, *, regional: bool = False) -> None:
    """See that a factor means something to imported matrices."""
    obstacle = None if spec.imported is None else spec.imported.obstacle(prop, regional=regional)
    if obstacle is not None:
        raise StudyError(f"update: {name}: {obstacle}")


def _general(prop: str, region: Region, spec: Spec) -> float:
    """Return what a region has of a property that it does not give itself."""
    thickness = spec.thickness if region.thickness is None else region.thickness
    return {
        "E": spec.material.E,
        "density": spec.material.density,
        "thickness": spec.thickness,
        "area": spec.width * thickness,
        "inertia": spec.width * thickness**3 / 12,
    }[prop]


def _damper(name: str, coefficient: str, predictor: Predictor, places: tuple[int, ...]) -> ModelParameter:
    """Return a coefficient of damping, never negative, on the scale that gives a per cent within the test's band."""
    spec = predictor.spec
    given = getattr(spec.damping, coefficient)
    if places:
        own = getattr(spec.regions[places[0]], coefficient)
        given = given if own is None else own
    omega = 2 * np.pi * predictor.measured.frequency
    scale = MIDDLING * {"alpha": 2 * omega.min(), "beta": 2 / omega.max(), "loss_factor": 2.0}[coefficient]
    return ModelParameter(
        name=name, unit=DAMPERS[coefficient], nominal=1.0, start=float(given or 0.0), low=0.0, high=MOST * scale,
        doubt=scale, tolerated=False,
        log=False, damper=coefficient, regions=places,
    )  # fmt: skip


def _factor(
    name: str, unit: str, nominal: float, tolerance: float, factor: str, regions: tuple[int, ...]
) -> ModelParameter:
    low, high = FACTOR_RANGE
    doubt = tolerance or UNTOLD
    return ModelParameter(
        name=name,
        unit=unit,
        nominal=nominal,
        start=1.0,
        low=low,
        high=high,
        doubt=doubt,
        tolerated=tolerance > 0,
        log=True,
        factor=factor,
        regions=regions,
    )


def _effect(
    name: str, effect: Effect, tail: str, predictor: Predictor, tolerances: Tolerances
) -> list[ModelParameter]:
    obstacle = effect.why_not(predictor)
    if obstacle is not None:
        raise StudyError(f"update: {effect.name} cannot be updated: {obstacle}")
    parameters = effect.parameters(predictor)
    stated = [p for p in parameters if p.needed]  # what has a default is updated only where it is named
    chosen = [p for p in parameters if p.name == tail] if tail else stated
    if not chosen:
        own = ", ".join(p.name for p in parameters) or "none"
        raise StudyError(f"update: {effect.name} has no parameter {tail!r} (it has: {own})")
    alone = len(stated) == 1 and chosen == stated
    model_parameters = []
    for p in chosen:
        low, high = (p.low, p.high) if effect.channel != "mass" or p.name != "mass" else (0.0, p.high)
        log = p.log and low > 0 and (p.name == "factor" or high > 1e3 * low)
        start = (
            1.0 if p.name in ("factor", "gain") else (0.0 if low <= 0 <= high else float(np.sqrt(low * high)))
        )
        width = np.log(high / low) if log else high - low
        model_parameter = ModelParameter(
            name=effect.name if alone else f"{effect.name}.{p.name}",
            unit=p.unit, nominal=1.0, start=start, low=low, high=high, doubt=float(width / np.sqrt(12)),
            tolerated=False, log=log,
            effect=effect.name, parameter=p.name,
        )  # fmt: skip
        in_model = _in_model(model_parameter, effect.scales(predictor), tolerances)
        model_parameters.append(_bounded(in_model, tolerances))
    return model_parameters


def _in_model(
    model_parameter: ModelParameter, scales: tuple[str, float] | None, tolerances: Tolerances
) -> ModelParameter:
    """Give a parameter that moves a factor of the model its place among these, and the tolerance it competes with."""
    if scales is None:
        return model_parameter
    factor, reach = scales
    tolerance = tolerances.of(model_parameter.name, model_parameter.competes_with) / reach
    return replace(
        model_parameter,
        factor=factor,
        reach=reach,
        doubt=tolerance or model_parameter.doubt,
        tolerated=tolerance > 0,
    )
