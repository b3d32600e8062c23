"""How figures and the report name effects, and the answer in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.quantities import p_value, percent, place, raised
from modalkit.output.how_far import beneath
from modalkit.output.names import sizes
from modalkit.output.shortcomings import WORDINGS
from updating import LIBRARY, Diagnosis
from updating.diagnosis.answer.ranked import Ranked

METRICS = {
    "frequency": "frequency",
    "damping": "damping",
    "frf": "FRF level and shape",
    "combined": "overall",
}
"""Channels as a sentence names them."""


def short(names: Sequence[str]) -> str:
    """Name a set of effects on a line: ``sensor mass + length``; a second one of a name is another one."""
    again = ("another " if name in names[:i] else "" for i, name in enumerate(names))
    stated = (f"{other}{name.replace('_', ' ')}" for other, name in zip(again, names, strict=True))
    return " + ".join(stated) or "tolerances alone"


def phrase(names: Sequence[str]) -> str:
    """Name a set of effects in a sentence."""
    return " together with ".join(
        (LIBRARY[name].words() if name in LIBRARY else name.replace("_", " ")) for name in names
    )


def parameters(row: Ranked) -> str:
    """Write the parameters of a row of the ranking on one line, those that the summary leaves aside last."""
    return "; ".join(raised(text) for text in sizes(row))


def answer(diagnosis: Diagnosis) -> str:
    """State the answer in one sentence."""
    if diagnosis.verdict == "none":
        text = "No gap to explain: tolerances and noise make differences like these"
        return f"{text}{beneath(diagnosis)} ({p_value(diagnosis.p_value)})"
    if diagnosis.verdict == "unknown" and not diagnosis.comparable:
        return (
            "Most measured modes have no partner in the model: the few that have one do not identify a cause"
        )
    if diagnosis.verdict == "unknown":
        content = f": {diagnosis.mechanism}" if diagnosis.mechanism else ""
        gap = f"A real gap ({p_value(diagnosis.p_value)})"
        lacks = "library" if diagnosis.mechanisms or diagnosis.lacks is None else diagnosis.lacks
        return f"{gap}, and {WORDINGS[lacks].headline}{content}"
    if diagnosis.verdict == "named":
        where, value = _detail(diagnosis)
        *first, last = [phrase([name]) for name in diagnosis.sets[0]]
        if first:
            comma = "," * (len(first) > 1)
            return f"{_capital(', '.join(first))}{comma} and {last} together explain the gap{value}"
        return f"{_capital(last)}{where} explains the gap{value}"
    named = [phrase(names) for names in diagnosis.sets]
    if len(named) > 4:
        named = [*named[:3], f"{len(named) - 3} others"]
    listed = ", ".join(named[:-1]) + " or " + named[-1]
    if diagnosis.level == "mechanism":
        return f"{_capital(raised(str(diagnosis.mechanism)))}: {listed}; these data cannot show which"
    return f"{_capital(listed)}: one of them explains the gap; these data cannot show which"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _detail(diagnosis: Diagnosis) -> tuple[str, str]:
    """Return the place of a cause with several parameters, or the value of the only parameter of another."""
    row = next((r for r in diagnosis.ranking if r.effects == diagnosis.sets[0]), None)
    if row is None:
        return "", ""
    if len(row.parameters) == 1:
        (estimate,) = row.parameters.values()
        return "", f": {raised(estimate.whole)}".replace(" ", "\N{NO-BREAK SPACE}")
    seated = diagnosis.where.location is not None and len(row.effects) == 1
    return (f" {located(diagnosis)}" if seated else ""), ""


def located(diagnosis: Diagnosis, *, plate: bool = False) -> str:
    """State where the cause sits."""
    at = diagnosis.where.location
    if diagnosis.where.names:
        return f"at {' and '.join(diagnosis.where.names)}"
    if at is None:
        return "no single place"
    flat = plate or len({zone.center[1] for zone in diagnosis.where.zones}) > 1
    return f"at {place(at, plate=flat)}"


def evidence(diagnosis: Diagnosis) -> str:
    """State in one line how large the gap was and how far it closes."""
    shrink = diagnosis.shrink
    parts = [diagnosis.title] if diagnosis.title else []
    if diagnosis.verdict == "none":
        parts.append(f"frequencies differ by {percent(diagnosis.gap.rms_percent)} r.m.s.")
        return "  ·  ".join(parts)
    before, after, floor = map(shrink.size, (shrink.held_before, shrink.held_after, shrink.floor))
    parts.append(f"{METRICS[shrink.metric]} gap {before} → {after} on modes held out, noise floor {floor}")
    if shrink.closed is not None and shrink.closed.determined:
        parts.append(f"reducible gap closed {shrink.closed}")
    return "  ·  ".join(parts)
