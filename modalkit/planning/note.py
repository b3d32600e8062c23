"""A forecast as a colleague would put it, in ten lines."""

from __future__ import annotations

from modalkit.planning.document import severity_text
from modalkit.planning.forecast import Advice, DesignForecast, Forecast
from modalkit.planning.separability import CLASS, NONE, SEEN, SURE

_LINES = 4

LARGER = 0.995
"""Below it a change makes the separable severities larger, by more than the digits shown [-]."""


def followed(found: Forecast) -> bool:
    """Return whether there is a change worth the trouble."""
    return bool(found.advice) and found.advice[0].worth > 0


def offered(found: Forecast) -> list[Advice]:
    """Return the changes that gain something, the most worth first; one that makes the test worse is no advice."""
    return [one for one in found.advice if one.worth > 0]


def brings(one: Advice) -> str:
    """Return what a change newly separates, and that the separable severities grow where they do; empty for neither."""
    larger = f"separable severities become {1 / one.factor:.2f} times larger" if one.factor < LARGER else ""
    return "; ".join(filter(None, (some(separated(one.separates)), larger)))


def note(found: Forecast) -> list[str]:
    """Return the forecast in a few sentences."""
    now = found.now
    lines = [_separates(now), _names(now), *_cannot(now), _from_when(now)]
    if followed(found):
        lines.append(_best(found.advice[0]))
    else:
        lines.append("Advice:  no single change that was tried is worth the effort.")
    return lines


def _separates(now: DesignForecast) -> str:
    pairs = list(now.shown_pairs.values())
    separately = sum(value >= SEEN for value in pairs)
    return (
        f"Pairs:   {separately} of {len(pairs)} pairs of effects are separated at the severities under "
        "'asked about' below."
    )


def _names(now: DesignForecast) -> str:
    kinds = [one.kind for one in now.outcomes.values()]
    edge, place = kinds.count("edge"), kinds.count("place")
    more = f", {edge} more on the edge ({SEEN:g} to {SURE:g} sigma)" if edge else ""
    more += f", {place} more with their place in doubt" if place else ""
    return (
        f"Named:   {kinds.count('named')} of {len(kinds)} effects would be named ({SURE:g} sigma "
        f"from all others){more}."
    )


def _cannot(now: DesignForecast) -> list[str]:
    lines, groups = [], [" = ".join(group) for group in now.classes]
    if groups:
        lines.append(
            f"Alike:   not separated (under {CLASS:g} sigma, all uncertainties included): "
            f"{some(groups, '; ', 'classes')}."
        )
    near = [
        f"{a} from {b} ({value:.1f} sigma)"
        for (a, b), value in sorted(now.shown_pairs.items(), key=lambda item: item[1])
        if value < SEEN and not any(a in group and b in group for group in now.classes)
    ]
    if near:
        lines.append(f"Hardly:  {some(near)}.")
    if now.unseen:
        lines.append(f"Unseen:  {some(list(now.unseen), what='effects')} would not be noticed.")
    return lines


def some(words: list[str], between: str = ", ", what: str = "pairs") -> str:
    """Return the first of a list, and how many more there are."""
    rest = len(words) - _LINES
    return between.join(words) if rest < 2 else f"{between.join(words[:_LINES])} and {rest} {what} more"


def separated(pairs: tuple[tuple[str, str], ...]) -> list[str]:
    """Return in words what a change separates."""
    return [f"shows {a}" if b == NONE else f"{a} from {b}" for a, b in pairs]


def _from_when(now: DesignForecast) -> str:
    """Return the effects that need to be largest, against what is asked about, to be separated."""
    seen = [name for name in now.limits if name not in now.unseen]
    hard = sorted(seen, key=lambda name: -now.limits[name].separated / now.limits[name].clear)[:_LINES]
    words = []
    for name in hard:
        limit = now.limits[name]
        never = f"{name} never ({limit.nearest} has the same effect)"
        words.append(severity_text(now, name, limit.separated) or never)
    return f"Late:    separated from all others only above these severities: {'; '.join(words)}."


def _best(best: Advice) -> str:
    newly = some(separated(best.separates))
    first = f"separates {newly}" if newly else "separates no further pair"
    less = best.factor >= LARGER
    times = f"{best.factor:.1f} times smaller" if less else f"{1 / best.factor:.1f} times larger"
    return f"Advice:  {best.change.measure}: {first}; separable severities become {times}."
