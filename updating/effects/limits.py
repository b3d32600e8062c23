"""What the stated values of an effect must be: what no structure has, or where it has none, is refused."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.errors import StudyError
from updating.effects.base import Parameter, Values

NOTHING = frozenset({"mass", "alpha", "beta", "loss_factor", "decay", "viscosity", "fluid_density"})
"""Parameters with a logarithmic prior that may still be stated as zero: no mass, no damping, no fluid."""

PLACES = frozenset({"x", "y", "z"})
"""Coordinates: their range is the structure."""

ROUNDED = 1e-3
"""How far, relative to its range, a coordinate may miss an edge: digits that a user does not write out [-]."""

NOT_NEGATIVE = frozenset({"mass", "stiffness", "bulk", "loss_factor"})
"""Parameters with a linear prior that are zero or more."""

WITHIN = frozenset({"inset", "cords", "joint"})
"""Parameters that make sense within their range alone."""

WHOLE_LOSS = 1.0
"""A loss of stiffness that leaves none [-]."""

FAR = 1e6
"""So many times beyond the prior a value is no mistake of judgement: its powers may be no numbers any more [-]."""


def check_values(parameters: Sequence[Parameter], values: Values, where: str) -> None:
    """See that stated values can be.

    Parameters
    ----------
    parameters : sequence of Parameter
        The effect's.
    values : mapping
        Values by name, defaults left out.
    where : str
        For the message.

    Raises
    ------
    StudyError
        If one cannot.
    """
    for parameter in parameters:
        if parameter.name in values and (wrong := _wrong(parameter, float(values[parameter.name]))):
            unit = "" if parameter.unit == "-" else f" {parameter.unit}"
            raise StudyError(f"{where}: {parameter.name} = {values[parameter.name]:g}{unit} {wrong}")


def _wrong(parameter: Parameter, value: float) -> str | None:
    """Return what is wrong with a value, or None."""
    name = parameter.name
    if not abs(value) <= FAR * max(abs(parameter.low), abs(parameter.high)):
        return f"is more than a million times outside the plausible range, {parameter.low:g} to {parameter.high:g}"
    if name in PLACES:
        slack = ROUNDED * (parameter.high - parameter.low)
        if not parameter.low - slack <= value <= parameter.high + slack:
            return f"is off the structure, which reaches from {parameter.low:g} to {parameter.high:g} m"
    elif name in WITHIN and not parameter.low <= value <= parameter.high:
        return f"must lie from {parameter.low:g} to {parameter.high:g}"
    elif name == "loss" and value >= WHOLE_LOSS:
        return "removes all stiffness; give a share below 1"
    elif (
        parameter.log
        and not parameter.signed
        and not (value > 0 or (value == 0 and (parameter.or_none or name in NOTHING)))
    ):
        return "must be positive"
    elif name in NOT_NEGATIVE and value < 0:
        return "must not be negative"
    return None
