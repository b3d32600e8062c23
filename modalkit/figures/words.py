"""How figures speak of effects, numbers and units."""

from __future__ import annotations

import math
from collections.abc import Sequence

from updating import LIBRARY, Diagnosis
from updating.diagnosis.answer.result import ParameterEstimate, Ranked

NO_BREAK = "\N{NO-BREAK SPACE}"

METRICS = {
    "frequency": "frequency",
    "damping": "damping",
    "frf": "FRF level and shape",
    "combined": "overall",
}
"""Channels as a sentence names them."""


def short(names: Sequence[str]) -> str:
    """Name a set of effects on a line: ``sensor mass + length``."""
    return " + ".join(name.replace("_", " ") for name in names) or "tolerances alone"


def phrase(names: Sequence[str]) -> str:
    """Name a set of effects in a sentence."""
    return " together with ".join(
        (LIBRARY[name].words() if name in LIBRARY else name.replace("_", " ")) for name in names
    )


def percent(value: float) -> str:
    """Write a percentage with two or three digits that mean something."""
    if not math.isfinite(value):
        return "–"
    size = abs(value)
    digits = 0 if size >= 99.95 else 1 if size >= 9.995 else 2 if size >= 0.095 else 3
    return f"{value:.{digits}f} %"


def gap_size(value: float, metric: str) -> str:
    """Write the size of a gap [%]; of all data together, where 100 % are one standard deviation, in these."""
    if metric != "combined":
        return percent(value)
    return f"{value / 100:.3g} σ" if math.isfinite(value) else "–"


def share(probability: float) -> str:
    """Write a probability as a percentage that is never a false 0 or 100."""
    if probability >= 0.9995:
        return "> 99.9 %"
    if probability < 0.001:
        return "< 0.1 %"
    return (
        f"{100 * probability:.1f} %"
        if probability < 0.1 or probability > 0.99
        else f"{100 * probability:.0f} %"
    )


def hertz(value: float) -> str:
    """Write a frequency."""
    return f"{value:.{2 if value < 99.995 else 1 if value < 999.95 else 0}f} Hz"


def chance(p_value: float) -> str:
    """Write a p-value."""
    if p_value < 1e-15:
        return "p < 1e-15"
    return f"p = {p_value:.2g}" if p_value >= 1e-3 else f"p = {p_value:.0e}"


def quantity(estimate: ParameterEstimate) -> str:
    """Write a value with its 95 % interval in a unit that suits it: ``12.1 g [11.5, 12.6]``; points as they are."""
    value, low, high = estimate.value, estimate.low95, estimate.high95
    if low is None or high is None or not isinstance(value, float):
        return str(estimate)
    factor, unit = _unit(estimate.unit, max(abs(value), abs(high)))
    stated, bottom, top = (_digits(factor * v) for v in (value, low, high))
    return f"{stated}{' ' + unit if unit else ''} [{bottom}, {top}]"


def _unit(unit: str, size: float) -> tuple[float, str]:
    unit = "" if unit == "-" else unit.replace("^2", "²").replace("^3", "³")
    return {"kg": (1e3, "g"), "m": (1e3, "mm")}.get(unit, (1.0, unit)) if size < 0.1 else (1.0, unit)


def _digits(value: float) -> str:
    size = abs(value)
    if size == 0 or 1e-2 <= size < 1e4:
        decimals = 2 if size == 0 else max(0, 2 - math.floor(math.log10(size)))
        return f"{value:.{decimals}f}"
    if 1e4 <= size < 1e6:
        return f"{round(value, -math.floor(math.log10(size)) + 2):.0f}"
    return f"{value:.2e}"


def parameters(row: Ranked) -> str:
    """Write the parameters of a row of the ranking on one line."""
    parts = []
    for name, estimate in row.parameters.items():
        bound = " at its bound" if estimate.at_bound else ""
        statement = name.rpartition(".")[2].replace("_", " ")
        parts.append(f"{statement} {quantity(estimate)}{bound}")
    return ", ".join(parts)


def answer(diagnosis: Diagnosis) -> str:
    """Say the answer in one sentence."""
    if diagnosis.verdict == "none":
        return f"No gap to explain: tolerances and noise account for every difference ({chance(diagnosis.p_value)})"
    if diagnosis.verdict == "unknown" and not diagnosis.comparable:
        return (
            "Most measured modes have no partner in the model: nothing can be named by the few that have one"
        )
    if diagnosis.verdict == "unknown":
        return f"A real gap ({chance(diagnosis.p_value)}), and nothing in the library of effects explains it"
    if diagnosis.verdict == "named":
        place, value = _detail(diagnosis)
        return f"{_capital(phrase(diagnosis.sets[0]))}{place} explains the gap{value}"
    named = [phrase(names) for names in diagnosis.sets]
    if len(named) > 4:
        named = [*named[:3], f"{len(named) - 3} others"]
    listed = ", ".join(named[:-1]) + " or " + named[-1]
    return f"{_capital(listed)}: one of them explains the gap, and these data cannot tell which"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _detail(diagnosis: Diagnosis) -> tuple[str, str]:
    """Return the place of a cause with several parameters, or the value of the only parameter of another."""
    row = next((r for r in diagnosis.ranking if r.effects == diagnosis.sets[0]), None)
    if row is None:
        return "", ""
    if len(row.parameters) == 1:
        statement = quantity(next(iter(row.parameters.values())))
        value, _, interval = statement.partition(" [")
        whole = f"(95 %: {interval.replace(', ', ' to ').replace(']', ')')}".replace(" ", NO_BREAK)
        return "", f": {value.replace(' ', NO_BREAK)} {whole}"
    seated = diagnosis.where.location is not None and len(row.effects) == 1
    return (f" {located(diagnosis)}" if seated else ""), ""


def located(diagnosis: Diagnosis, *, plate: bool = False) -> str:
    """Say where the cause sits."""
    place = diagnosis.where.location
    if place is None:
        return "no single place"
    flat = plate or len({zone.center[1] for zone in diagnosis.where.zones}) > 1
    across = f", y = {place[1]:.3f} m" if flat else ""
    return f"at x = {place[0]:.3f} m{across}"


def evidence(diagnosis: Diagnosis) -> str:
    """Say in one line how large the gap was and how far it closes."""
    shrink = diagnosis.shrink
    parts = [diagnosis.title] if diagnosis.title else []
    if diagnosis.verdict == "none":
        parts.append(f"frequencies differ by {percent(diagnosis.gap.rms_percent)} r.m.s.")
        return "  ·  ".join(parts)
    before, after, floor = (
        gap_size(value, shrink.metric) for value in (shrink.held_before, shrink.held_after, shrink.floor)
    )
    parts.append(f"{METRICS[shrink.metric]} gap {before} → {after} on modes held out, noise floor {floor}")
    if shrink.closed is not None:
        closed = shrink.closed
        low, high = f"{closed.low95:.0f}", f"{closed.high95:.0f}"
        interval = f" ({low} to {high} %)" if low != high else ""
        parts.append(f"closes {closed.value:.0f} % of what can close{interval}")
    return "  ·  ".join(parts)
