"""Effects as a user names them on the command line, and whether they fit a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches

import numpy as np

from acquisition.errors import InputError, StudyError
from updating import LIBRARY, Predictor
from updating.models.state import State

EffectValues = tuple[str, Mapping[str, float]]


def departure(name: str, values: Mapping[str, float]) -> Callable[[Predictor], State]:
    """Return the function that puts an effect into a predictor's model."""
    return lambda predictor: LIBRARY[name].state(predictor, values)


def parse_effect(text: str) -> tuple[str, dict[str, float]]:
    """Read an effect written NAME or NAME:PARAM=VALUE,PARAM=VALUE.

    Raises
    ------
    InputError
        If the effect is unknown or a value is no number.
    """
    name, _, rest = (part.strip() for part in text.partition(":"))
    if name not in LIBRARY:
        near = get_close_matches(name, LIBRARY, n=3)
        meant = f"did you mean {' or '.join(near)}?" if near else "`modalkit effects` lists them"
        raise InputError(f"--effect {text}: there is no effect {name!r}; {meant}")
    values = {}
    for entry in filter(None, (part.strip() for part in rest.split(","))):
        parameter, equals, number = (part.strip() for part in entry.partition("="))
        try:
            values[parameter] = float(number)
        except ValueError:
            equals = ""
        if not equals or not np.isfinite(values[parameter]):
            raise InputError(f"--effect {text}: {entry!r} is no PARAM=VALUE; write {name}:PARAM=VALUE,...")
    return name, values


def check_effect(
    predictor: Predictor, name: str, values: Mapping[str, float], *, where: str = "--effect"
) -> None:
    """Refuse an effect that does not fit the model, and parameters that do not fit the effect."""
    effect = LIBRARY[name]
    if effect.channel == "measurement" and predictor.spec.kind in effect.models:
        obstacle = None  # what a diagnosis would need of the data is no obstacle to simulating them
    else:
        obstacle = effect.why_not(predictor)
    if obstacle is not None:
        raise StudyError(f"{where} {name}: {obstacle}")
    takes = {p.name: p for p in effect.parameters(predictor)}
    if set(values) != set(takes):
        wanted = ", ".join(f"{p.name} [{p.unit}]" for p in takes.values()) or "no parameters"
        raise StudyError(f"{where} {name}: it takes {wanted}, found {', '.join(sorted(values)) or 'none'}")
    for p in takes.values():
        if p.log and not values[p.name] > 0:
            raise StudyError(f"{where} {name}: {p.name} = {values[p.name]:g} {p.unit} must be positive")


def said(effects: Sequence[EffectValues]) -> str:
    """Return effects as they are written on the command line."""
    parts = [
        name + (":" if values else "") + ",".join(f"{k}={v:g}" for k, v in values.items())
        for name, values in effects
    ]
    return " ".join(parts) or "no effect"
