"""Effects as a study or the command line states them: numbers for parameters, node numbers for points."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from acquisition.errors import StudyError
from acquisition.si_units import si_value
from modalkit.study.errors import nearest
from updating import LIBRARY
from updating.effects import Effect
from updating.effects.specimens import unit_of
from updating.models.spec import Kind

SOME = "points"
"""The label that takes several node numbers; any other takes one."""

BEFORE = "before"
"""Key of an entry that states whether the effect was there in the baseline, too."""


def was_before(entry: Mapping[str, Any]) -> bool:
    """Return whether the effect of one ``[[model.effect]]`` was there in the baseline, too.

    Where the entry does not say, an effect of the structure was, and one of the measurement was not: that belongs to
    one test.

    Raises
    ------
    StudyError
        If ``before`` is neither true nor false.
    """
    stated = entry.get(BEFORE)
    if stated is None:
        effect = LIBRARY.get(str(entry.get("name")))
        return effect is None or effect.channel != "measurement"
    if not isinstance(stated, bool):
        raise StudyError(
            f"[[model.effect]] {entry.get('name')}: before = {stated!r} must be true (the effect was there in the "
            "baseline, too) or false (it came afterwards)"
        )
    return stated


def accepted_values(entry: Mapping[str, Any], kind: Kind = "beam") -> tuple[str, dict[str, Any]]:
    """Return name and values of one ``[[model.effect]]``.

    Parameters
    ----------
    entry : mapping
        ``name``, and a value for each parameter and each label of the effect: ``points = [3]``, ``point = 3``;
        ``before`` is for :func:`was_before`.
        A value may be a text with its unit, ``mass = "8.6 g"``.
    kind : {"beam", "plate", "matrices"}
        Kind of model, on which the unit of a spring along an edge depends.

    Raises
    ------
    StudyError
        If the effect is unknown, or a value is not what it takes.
    """
    values = {key: value for key, value in entry.items() if key not in ("name", BEFORE)}
    name = entry.get("name")
    if not isinstance(name, str) or name not in LIBRARY:
        meant = nearest(str(name), tuple(LIBRARY))
        raise StudyError(f"[[model.effect]] unknown effect {name!r}{meant}; `modalkit effects` lists them")
    try:
        return name, {k: stated_value(LIBRARY[name], k, v, kind) for k, v in values.items()}
    except StudyError as error:
        raise StudyError(f"[[model.effect]] {name}: {error}") from error


def check_repeated(names: Sequence[str]) -> None:
    """See that no effect is given twice that a structure or a test has but once.

    Raises
    ------
    StudyError
        If one does.
    """
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1 and not LIBRARY[name].several]
    if twice:
        raise StudyError(
            f"[[model.effect]] {twice[0]} is given twice, but it can occur only once; combine both entries"
        )


def stated_value(effect: Effect, name: str, value: Any, kind: Kind) -> Any:
    """Return the value of a label or a parameter of an effect.

    Raises
    ------
    StudyError
        If it is not what the parameter takes.
    """
    if name in effect.labels:
        return _nodes(name, value)
    if name == "channel" and effect.of_sensor:
        return _sensor(value)
    if name in effect.named and isinstance(value, str):
        return value
    return _number(name, value, unit_of(effect, name, kind) if isinstance(value, str) else "")


def _sensor(value: Any) -> str:
    """Return the fixed sensor that ``channel`` names: its node and direction, or its node."""
    if (
        isinstance(value, bool)
        or not isinstance(value, str | int)
        or not _SENSOR.fullmatch(str(value).strip())
    ):
        raise StudyError(f'channel = {value!r} is not a fixed sensor; write its node and direction, as "5+Z"')
    return str(value).strip()


_SENSOR = re.compile(r"\d{1,9}([+-]R?[XYZxyz])?")


def _nodes(label: str, value: Any) -> int | tuple[int, ...]:
    """Return the node numbers that a label names: a tuple for ``points``, one number for ``point``."""
    several = label == SOME
    given = list(value) if several and isinstance(value, list | tuple) else [value]
    if not given or not all(isinstance(v, int) and not isinstance(v, bool) for v in given):
        wanted = "a list of node numbers, as [3, 4]" if several else "one node number, as 3"
        raise StudyError(f"{label} = {value!r} is not {wanted}")
    if len(set(given)) < len(given):
        raise StudyError(f"{label} = {value!r} names a point twice")
    return tuple(given) if several else int(given[0])


def _number(name: str, value: Any, unit: str) -> float:
    try:
        value = si_value(value, unit)
    except ValueError as error:
        raise StudyError(f"{name}: {error}") from error
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise StudyError(f"{name} = {value!r} must be a number")
    return float(value)
