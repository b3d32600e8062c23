"""Effects as a user names them on the command line, and whether they fit a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

import numpy as np

from acquisition.errors import InputError, StudyError
from modalkit.study.stated_effects import SOME, stated_value
from updating import LIBRARY, Predictor
from updating.effects import Effect, check_values, hypotheses_of, labels_of, names_of, optional_values
from updating.models.spec import Kind, Spec
from updating.models.state import State

EffectValues = tuple[str, Mapping[str, Any]]


def departure(name: str, values: Mapping[str, Any]) -> Callable[[Predictor], State]:
    """Return the function that puts an effect into a predictor's model."""
    return lambda predictor: effects_of(predictor.spec)[name].state(predictor, predictor.unstretched(values))


def effects_of(spec: Spec) -> Mapping[str, Effect]:
    """Return the effects of the library and the hypotheses of a model, by name."""
    return {**LIBRARY, **{effect.name: effect for effect in hypotheses_of(spec)}}


def parse_effect(
    text: str, kind: Kind = "beam", effects: Mapping[str, Effect] = LIBRARY
) -> tuple[str, dict[str, Any]]:
    """Read an effect written NAME or NAME:PARAM=VALUE,PARAM=VALUE; points are node numbers, as points=3/4.

    Parameters
    ----------
    text : str
        As typed; a value may have its unit, ``lumped_mass:mass=20g,x=100mm``, and is in SI units without.
    kind : {"beam", "plate", "matrices"}
        Kind of model, on which the unit of a spring along an edge depends.
    effects : mapping of str to Effect
        What there is: the library, and of some models their study's hypotheses.

    Raises
    ------
    InputError
        If the effect is unknown or a value is not a number.
    """
    name, _, rest = (part.strip() for part in text.partition(":"))
    if name not in effects:
        near = get_close_matches(name, effects, n=3)
        meant = f"did you mean {' or '.join(near)}?" if near else "`modalkit effects` lists them"
        raise InputError(f"--effect {text}: there is no effect {name!r}; {meant}")
    effect, values = effects[name], dict[str, Any]()
    for entry in filter(None, (part.strip() for part in rest.split(","))):
        parameter, _, stated = (part.strip() for part in entry.partition("="))
        if parameter in values:
            raise InputError(f"--effect {text}: {parameter} is given twice")
        try:
            typed = _typed(effect, parameter, stated)
            if typed is None:
                raise StudyError(f"{entry!r} is not PARAM=VALUE; write {name}:PARAM=VALUE,...")
            values[parameter] = stated_value(effect, parameter, typed, kind)
        except StudyError as error:
            raise InputError(f"--effect {text}: {error}") from error
    return name, values


def _typed(effect: Effect, parameter: str, stated: str) -> Any:
    """Return what a study file would have for a value typed: nodes written 3/4, a number, a text; None for no value."""
    if parameter in effect.labels:
        try:
            found = [int(part) for part in stated.split("/")]
        except ValueError as error:
            wanted = f"{parameter}=3/4" if parameter == SOME else f"{parameter}=3"
            raise StudyError(f"{stated!r} are not node numbers; write {wanted}") from error
        return found if parameter == SOME or len(found) > 1 else found[0]
    if parameter in effect.named or (parameter == "channel" and effect.of_sensor):
        return stated or None
    try:
        number = float(stated)
    except ValueError:
        return stated if stated[:1].isdigit() else None
    return number if np.isfinite(number) else None


def check_effect(
    predictor: Predictor, name: str, values: Mapping[str, Any], *, where: str = "--effect"
) -> None:
    """Refuse an effect that does not fit the model, and parameters that do not fit the effect."""
    effect, tested = effects_of(predictor.spec)[name], _as_tested(predictor)
    if effect.channel == "measurement" and predictor.spec.kind in effect.models:
        obstacle = None  # what a diagnosis would need of the data is no obstacle to simulating them
    else:
        obstacle = effect.why_not(tested)
    if obstacle is not None:
        raise StudyError(f"{where} {name}: {obstacle}")
    takes = {p.name: p for p in effect.parameters(tested)}
    labels, names = labels_of(effect, values), names_of(effect, predictor.spec)
    needed = {*labels, *takes} - optional_values(effect, tuple(takes.values()), values, predictor.spec)
    if not needed <= set(values) <= {*takes, *labels, *names}:
        stated = [f"{label} (node numbers)" for label in effect.labels]
        stated += sorted(names)
        wanted = ", ".join([*stated, *(f"{p.name} [{p.unit}]" for p in takes.values())]) or "no parameters"
        raise StudyError(f"{where} {name}: it takes {wanted}, found {', '.join(sorted(values)) or 'none'}")
    for label in labels - {"channel"}:
        given = values[label] if isinstance(values[label], tuple) else (values[label],)
        if missing := [node for node in given if node not in predictor.measured.nodes]:
            there = ", ".join(map(str, predictor.measured.nodes[:12]))
            raise StudyError(f"{where} {name}: the test has no point {missing[0]}; it has {there}")
    check_values(tuple(takes.values()), values, f"{where} {name}")


def _as_tested(predictor: Predictor) -> Predictor:
    """Return the predictor of a test that found some modes with their damping, as one of the simulated data will."""
    test = predictor.measured
    frequency = test.frequency if len(test.frequency) else predictor.predict(count=5).frequency
    return predictor.for_test(replace(test, frequency=frequency, damping=np.full(len(frequency), 0.01)))


def written(value: Any) -> str:
    """Return a value as it is written on the command line."""
    if isinstance(value, tuple):
        return "/".join(map(str, value))
    if isinstance(value, str):
        return value
    return f"{value:g}"


def effects_text(effects: Sequence[EffectValues]) -> str:
    """Return effects as they are written on the command line."""
    parts = [
        name + (":" if values else "") + ",".join(f"{k}={written(v)}" for k, v in values.items())
        for name, values in effects
    ]
    return " ".join(parts) or "no effect"
