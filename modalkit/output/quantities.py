"""Quantities as one says them: few digits, handy units, an interval."""

from __future__ import annotations

from updating.diagnosis.answer.result import ParameterEstimate

HANDY = {"kg": (1.0, 1000.0, "g"), "m": (1.0, 1000.0, "mm"), "s": (1e-3, 1e6, "us")}
"""Per unit: below which size, times what, in which unit it is said."""


def number(value: float) -> str:
    """Return a number with three digits, and no exponent where none is needed."""
    if value != 0 and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.2e}"
    return f"{float(f'{value:.3g}'):.10g}"


def size(estimate: ParameterEstimate) -> str:
    """Return an estimate with its 95 % interval, in a handy unit."""
    value, low, high = estimate.value, estimate.low95, estimate.high95
    if isinstance(value, str | tuple) or low is None or high is None:
        return str(estimate)
    bar, times, unit = HANDY.get(estimate.unit, (0.0, 1.0, estimate.unit))
    if max(abs(low), abs(high)) < bar:
        value, low, high = (times * v for v in (value, low, high))
    else:
        unit = estimate.unit
    statement = "" if unit in {"-", "node"} else f" {unit}"
    return f"{number(value)}{statement} ({number(low)} to {number(high)})"


def place(at: tuple[float, float, float]) -> str:
    """Return a place in millimetres; on a beam, y and z are zero and left out."""
    x, y, z = at
    statement = [f"x = {1000 * x:.0f}"] + [f"{n} = {1000 * v:.0f}" for n, v in (("y", y), ("z", z)) if v]
    return ", ".join(statement) + " mm"
