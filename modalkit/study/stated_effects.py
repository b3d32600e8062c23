"""Effects as a study or the command line states them: numbers for parameters, node numbers for points."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from acquisition.errors import StudyError
from acquisition.si_units import si_value
from modalkit.study.errors import nearest
from updating import LIBRARY

SOME = "points"
"""The label that takes several node numbers; any other takes one."""

UNITS = {
    "extension": "m",
    "x": "m",
    "y": "m",
    "z": "m",
    "dx": "m",
    "dy": "m",
    "extent": "m",
    "mass": "kg",
    "force": "N",
    "fluid_density": "kg/m^3",
    "viscosity": "Pa s",
    "alpha": "1/s",
    "beta": "s",
    "decay": "1/s",
    "delay": "s",
    "slope": "1/N",
}
"""Units of the parameters of effects; those that are not here are ratios."""

OWN_UNITS = {
    ("damping_patch", "mass"): ("", ""),
    ("clamp_rotation", "stiffness"): ("N m/rad", "N m/rad per m"),
    ("clamp_translation", "stiffness"): ("N/m", "N/m per m"),
}
"""Units that a parameter has in one effect alone: on a plate the second, else the first."""


def unit_of(effect: str, parameter: str, kind: str) -> str:
    """Return the unit of a parameter of an effect on a kind of model, "" for a ratio."""
    own = OWN_UNITS.get((effect, parameter))
    return UNITS.get(parameter, "") if own is None else own[kind == "plate"]


def accepted_values(entry: Mapping[str, Any], kind: str = "beam") -> tuple[str, dict[str, Any]]:
    """Return name and values of one ``[[model.effect]]``.

    Parameters
    ----------
    entry : mapping
        ``name``, and a value for each parameter and each label of the effect: ``points = [3]``, ``point = 3``.
        A value may be a text with its unit, ``mass = "8.6 g"``.
    kind : {"beam", "plate", "matrices"}
        Kind of model, on which the unit of a spring along an edge depends.

    Raises
    ------
    StudyError
        If the effect is unknown, or a value is not what it takes.
    """
    values = {key: value for key, value in entry.items() if key != "name"}
    name = entry.get("name")
    if not isinstance(name, str) or name not in LIBRARY:
        meant = nearest(str(name), tuple(LIBRARY))
        raise StudyError(f"[[model.effect]] knows no effect {name!r}{meant}; `modalkit effects` lists them")
    try:
        return name, {k: _value(name, k, v, kind) for k, v in values.items()}
    except StudyError as error:
        raise StudyError(f"[[model.effect]] {name}: {error}") from error


def _value(effect: str, name: str, value: Any, kind: str) -> Any:
    """Return the value of a label or a parameter of an effect."""
    if name in LIBRARY[effect].labels:
        return nodes(name, value)
    if name == "channel" and LIBRARY[effect].of_sensor:
        return sensor(value)
    return _number(name, value, unit_of(effect, name, kind))


def sensor(value: Any) -> str:
    """Return the fixed sensor that ``channel`` speaks of: its node and direction, or its node.

    Raises
    ------
    StudyError
        If the value is something else.
    """
    if (
        isinstance(value, bool)
        or not isinstance(value, str | int)
        or not _SENSOR.fullmatch(str(value).strip())
    ):
        raise StudyError(f'channel = {value!r} is no fixed sensor; write its node and direction, as "5+Z"')
    return str(value).strip()


_SENSOR = re.compile(r"\d{1,9}([+-]R?[XYZxyz])?")


def nodes(label: str, value: Any) -> int | tuple[int, ...]:
    """Return the node numbers that a label speaks of: a tuple for ``points``, one number for ``point``.

    Raises
    ------
    StudyError
        If the value is something else, or a node stands twice.
    """
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
