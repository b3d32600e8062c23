"""Points of a test that is only planned, as a study writes them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import PlainValidator

from acquisition.dof import Dof
from acquisition.errors import ModalkitError
from acquisition.si_units import si_value

WAYS = ("x", "y", "z")

PlainPoint = float | str | tuple[Any, ...]
"""A place along a beam [m]; a node of the model and its direction, ``12+Z``; or coordinates [m] and a direction."""


def planned_point(value: Any) -> PlainPoint:
    """Return a point written ``0.15``, ``"12+Z"``, ``[0.1, 0.2]`` or ``[0.1, 0.0, 0.3, "+x"]``, its direction always.

    Raises
    ------
    ValueError
        If it is written otherwise.
    """
    if isinstance(value, list | tuple):
        return _coordinates(list(value))
    if isinstance(value, str):
        try:
            return str(Dof.of(value))
        except ModalkitError:
            pass
    try:
        return float(si_value(value, "m"))
    except (TypeError, ValueError) as error:
        raise ValueError(_HOW.format(value)) from error


_HOW = (
    "{!r} is not a point; write a place along a beam [m], a node of the model and its direction as "
    '"12+Z", or coordinates [m] and a direction as [0.1, 0.0, 0.3, "+x"]'
)


def _coordinates(value: list[Any]) -> PlainPoint:
    """Return coordinates and a direction, z where none is stated."""
    way = str(value.pop()).lower() if value and str(value[-1]).lower().lstrip("+-") in WAYS else "+z"
    if len(value) not in (2, 3):
        raise ValueError(_HOW.format(value))
    try:
        at = tuple(float(si_value(v, "m")) for v in value)
    except (TypeError, ValueError) as error:
        raise ValueError(_HOW.format(value)) from error
    return (*at, way if way[0] in "+-" else f"+{way}")


PlannedPoint = Annotated[Any, PlainValidator(planned_point)]
