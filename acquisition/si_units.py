"""Quantities of a study or a layout: a number in SI units, or a text with its unit, as ``"376 mm"``."""

from __future__ import annotations

import math
import re
from functools import cache
from tokenize import TokenError
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pint import Unit, UnitRegistry

_QUANTITY = re.compile(r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.DOTALL)
_UNIT = re.compile(r"[A-Za-zµμ°%Å0-9²³⁻¹·*/^() .-]{0,40}")
_BARE_POWER = re.compile(r"(?<=[A-Za-zµμ])(-?[1-4])(?![0-9])")
"""A power without a sign for it, as in ``kg/m3``."""

SHARES = frozenset({"percent", "permille", "ppm"})
"""Units in which ratios may be written; decibels and angles are none."""

WHOLE = 1e-9
"""So near to a whole number, relative, a factor or its inverse is one: 3.175 mm is 0.003175 m to the last bit [-]."""

LARGEST = 1e15
"""Above this a floating-point number is whole anyway [-]."""


def si_value(value: Any, unit: str) -> Any:
    """Return what a text with a unit means in SI units; anything but a text as it is.

    Parameters
    ----------
    value : object
        Of the file: ``"376 mm"``, or a number, which is in SI units already.
    unit : str
        The SI unit that is asked for; "" for ratios, which may be given in per cent.

    Raises
    ------
    ValueError
        If the text is not a quantity, or one of another kind.
    """
    if not isinstance(value, str):
        return value
    found = None if "," in value else _QUANTITY.fullmatch(value.strip())
    if found is None:
        raise ValueError(
            f"{value!r} is not a quantity; write a number with a decimal point and its unit, as "
            f"{_example(unit)}"
        )
    number, written = float(found[1]), found[2].strip()
    quantity = number if not written else _scaled(number, _factor(written, unit, value))
    if not math.isfinite(quantity):
        raise ValueError(f"{value!r} is not a finite number")
    return quantity


def _scaled(number: float, factor: float) -> float:
    """Multiply; a factor that is a whole number, or one over it, but for rounding is taken as that."""
    larger = factor if factor >= 1 else 1 / factor
    if larger < LARGEST and abs(larger - round(larger)) < WHOLE * larger:
        larger = round(larger)
    return number * larger if factor >= 1 else number / larger


def _factor(written: str, unit: str, value: str) -> float:
    """Return how many SI units one of the written ones is [-]."""
    given = _unit(written)
    wanted = _unit(unit or "dimensionless")
    if given is None or wanted is None:
        raise ValueError(
            f"{value!r}: no unit {written!r} is known; write {_example(unit)}, or a number in SI units"
        )
    one = _registry().Quantity(1, given)
    if not unit and not {str(name) for name, _ in one.unit_items()} <= SHARES:
        raise ValueError(f"{value!r} is a quantity, and a ratio is asked for; write it as {_example(unit)}")
    if one.dimensionality != _registry().Quantity(1, wanted).dimensionality:
        raise ValueError(f"{value!r} is not a quantity in {unit or 'ratios'}; write it as {_example(unit)}")
    turns = dict(one.to_root_units().unit_items()).get("radian", 0)
    if turns not in (0, dict(_registry().Quantity(1, wanted).to_root_units().unit_items()).get("radian", 0)):
        raise ValueError(f"{value!r} is an angular rate; give it in Hz, or as 1/s")
    return float(one.to_base_units().magnitude)


def _unit(written: str) -> Unit | None:
    """Return a unit in pint, or None."""
    if not _UNIT.fullmatch(written):
        return None
    text = _BARE_POWER.sub(r"^\1", written.replace("·", "*").replace("μ", "µ"))
    try:
        return _registry().parse_units(f"1{text}" if text.startswith("/") else text)
    except (ArithmeticError, AssertionError, AttributeError, SyntaxError, TokenError, TypeError, ValueError):
        return None


@cache
def _registry() -> UnitRegistry[float]:
    """Return the table of units, loaded the first time that a study states one."""
    from pint import UnitRegistry

    return UnitRegistry()


def _example(unit: str) -> str:
    return {
        "m": '"376 mm"',
        "Pa": '"210 GPa"',
        "kg/m^3": '"7.85 g/cm^3"',
        "kg": '"8.6 g"',
        "Hz": '"1.2 kHz"',
        "": '0.02 or "2 %"',
        "s": '"5 us"',
    }.get(unit, f'"1 {unit}"')
