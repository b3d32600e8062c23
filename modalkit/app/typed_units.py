"""Values of updated parameters in the unit in which the study has them: 70 GPa, not 7e+10 Pa."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from acquisition.si_units import si_value

HANDY = {"Pa": ("GPa", 1e9), "m": ("mm", 1e-3)}
"""Unit, and what one of it is in SI units, where the study has a number without a unit."""

WRITTEN = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(.+)")
"""A number with its unit."""


def unit_as_typed(content: Mapping[str, Any], name: str, unit: str) -> tuple[str, float]:
    """Return the unit in which a study states a parameter, and what one of it is [``unit``].

    Parameters
    ----------
    content : mapping
        Tables of the study.
    name : str
        Of the parameter: ``E``, ``root.E``, ``sensor_mass.mass``.
    unit : str
        Its SI unit.
    """
    owner, _, key = name.rpartition(".")
    for value in _stated(content.get("model", {}), owner, key):
        found = WRITTEN.fullmatch(value.strip()) if isinstance(value, str) else None
        if found is not None:
            try:
                return found[2], float(si_value(f"1 {found[2]}", unit))
            except ValueError:  # of another kind: another key of the same name
                continue
    return HANDY.get(unit, (unit, 1.0))


def _stated(model: Mapping[str, Any], owner: str, key: str) -> Iterator[Any]:
    """Yield what a model states under a key, that of the owner first: a region, an effect."""
    for table in (*model.get("region", []), *model.get("effect", [])):
        if table.get("name") == owner:
            yield table.get(key)
    yield model.get("material", {}).get(key)
    yield model.get(key)


def parameter_rows(content: Mapping[str, Any], parameters: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the parameters of an update as they are shown, numbers as texts.

    Parameters
    ----------
    content : mapping
        Tables of the study.
    parameters : list of dict
        As the document of the update has them.
    """
    rows = []
    for one in parameters:
        unit, times = unit_as_typed(content, one["name"], one["unit"])
        value, low, high = one["value"], one["low"], one["high"]
        ends = [
            abs(end - value) if end is not None and value is not None else float("inf") for end in (low, high)
        ]
        rows.append(
            {
                "name": one["name"],
                "unit": "" if unit == "-" else unit,
                "initial": _digits(one["initial"], times),
                "value": _digits(value, times),
                "sigma": _digits(one["sigma"], times, 3),
                "factor": _digits(one["factor"], 1.0),
                "bounds": f"{_digits(low, times, 4)} to {_digits(high, times, 4)}",
                "at_bound": "no" if not one["at_bound"] else "lower" if ends[0] <= ends[1] else "upper",
            }
        )
    return rows


def _digits(value: float | None, times: float, digits: int = 6) -> str:
    return "–" if value is None else f"{value / times:.{digits}g}"
