"""The answer at the level of the mechanism, as text: what several sets do alike, and what a nameless cause is not."""

from __future__ import annotations

from acquisition.quantities import probability, quantity
from updating import Diagnosis
from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE
from updating.diagnosis.answer.mechanism import Alike, Mechanism
from updating.diagnosis.answer.ranked import Ranked

LEAST = 1e-3
"""Sets with less of the probability are not listed [-]."""

SHOWN = 4
"""So many sets, or mechanisms, are listed."""


def shared_text(diagnosis: Diagnosis) -> str:
    """State what the sets of an answer do alike, and the sets: ``mass near x = 130 mm, 50.7 g (49.4 to 52): ...``."""
    leading = diagnosis.mechanisms[0]
    kept = [one for one in leading.sets if one.probability >= LEAST or one.effects in diagnosis.sets][:SHOWN]
    whole = sum(one.probability for one in leading.sets)
    listed = [f"{_set(diagnosis, one)} ({probability(one.probability / whole)})" for one in kept]
    more = len(leading.sets) - len(kept) if len(kept) == SHOWN else 0
    others = f" or {more} more" if more else ""
    return f"{leading}: {' or '.join(listed)}{others}"


def _set(diagnosis: Diagnosis, one: Alike) -> str:
    """Name a set; of one effect that reaches over a stretch, with the length of that."""
    if one.effects == (SOMETHING_ELSE,):
        return "a cause outside the library"
    row: Ranked | None = next((row for row in diagnosis.ranking if row.effects == one.effects), None)
    long = None if row is None or len(one.effects) > 1 else row.parameters.get(f"{one.effects[0]}.extent")
    stretch = f" of {quantity(long.value, long.unit)}" if long and isinstance(long.value, float) else ""
    return " + ".join(one.effects) + stretch


def content_text(diagnosis: Diagnosis) -> str:
    """State what is known of a cause without a name: channel, place and size with intervals, and what is excluded."""
    listed = "; ".join(_part(one) for one in diagnosis.mechanisms[:SHOWN])
    return f"{listed} (95 % in brackets){_excluded(diagnosis)}"


def _part(one: Mechanism) -> str:
    size = f", {one.size}" if one.size else ""
    return f"{one.channel} {one.where}{interval(one)}{size}, with a probability of {probability(one.probability)}"


def interval(one: Mechanism) -> str:
    """Return the 95 % interval of a place along each axis in which it has one: ``(82 to 158)``."""
    if one.location_low95 is None or one.location_high95 is None or len(one.locations) != 1:
        return ""
    ends = zip("xyz", one.location_low95, one.location_high95, strict=True)
    stated = {axis: f"{1e3 * low:.0f} to {1e3 * high:.0f}" for axis, low, high in ends if high > low}
    if len(stated) < 2:
        return "".join(f" ({text})" for text in stated.values())
    return f" ({', '.join(f'{axis} {text}' for axis, text in stated.items())})"


def _excluded(diagnosis: Diagnosis) -> str:
    """State which channels a cause without a name does not change, and which single effects are ruled out."""
    other = diagnosis.something_else
    if other is None:
        return ""
    least = 1 - diagnosis.rules.credible_share
    channels = [name for name, share in other.channels.items() if share < least]
    first = diagnosis.ranking[0] if diagnosis.ranking else None
    sets = [" + ".join(first.effects)] if first and 1 - other.probability < least else []
    named = [*channels, *sets]
    return f"; excluded: {', '.join(named)}" if named else ""
