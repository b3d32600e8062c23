"""Which clamped edges of a beam or a plate give way, along which stretch: the forms of a clamp and what is stated."""

from __future__ import annotations

from collections.abc import Sequence

from acquisition.errors import StudyError
from updating.effects.base import Values, Variant
from updating.models.spec import Spec

ALL = "all"
"""Name of all clamps together, which give way alike, and of all directions in which a support holds."""

ALIKE = 0.5
"""Prior share of all clamps alike among the clamps of a structure that has several: made and tightened alike, or one of
them loose. Doubled, one alone is out of the question."""

WHOLE_EDGE = 0.7
"""Prior share of clamps of plates that give way along their whole edge [-]: made so, or not tightened enough, as
against one loose bolt, a warped jaw or dirt in it. Judged; doubled, a part of the edge gains ln 2."""

OFF = 1e-3
"""How far, relative to the edge, a stated stretch may miss its ends: digits that a user does not write out [-]."""


def whole_clamps(spec: Spec) -> tuple[Variant, ...]:
    """Return each of several clamps, and all of them alike; the one form there is where there is one clamp."""
    clamped = spec.clamped
    if len(clamped) < 2:
        return (Variant(),)
    alone = tuple(Variant({"support": edge}, (1 - ALIKE) / len(clamped)) for edge in clamped)
    return (Variant({"support": ALL}, ALIKE), *alone)


def clamps_and_stretches(spec: Spec) -> tuple[Variant, ...]:
    """Return the clamps of a plate along their whole edges, and each along a part of its own."""
    most = longest(spec)
    whole = [
        Variant({**form.values, "from": 0.0, "to": most}, WHOLE_EDGE * form.weight)
        for form in whole_clamps(spec)
    ]
    share = (1 - WHOLE_EDGE) / max(len(spec.clamped), 1)
    named = len(spec.clamped) > 1
    return (*whole, *(Variant({"support": edge} if named else {}, share) for edge in spec.clamped))


def edge_size(spec: Spec, edge: str) -> float:
    """Return the length of an edge of a plate [m]."""
    return spec.width if edge[0] == "x" else spec.length


def longest(spec: Spec) -> float:
    """Return the length of the longest clamped edge of a plate, as far as the prior of a stretch reaches [m]."""
    return max((edge_size(spec, edge) for edge in spec.clamped), default=0.0)


def stretch_of(spec: Spec, edges: Sequence[str], values: Values) -> tuple[float, float] | None:
    """Return from where to where along an edge a clamp gives way [m]; None along all of it.

    Raises
    ------
    StudyError
        If the stretch is off the edge, has no direction, or one of several edges is meant.
    """
    if spec.kind != "plate":
        return None
    size = min(edge_size(spec, edge) for edge in edges)
    low, high = float(values.get("from", 0.0)), float(values.get("to", size))
    if -OFF * size <= low <= 0.0 and size * (1 - OFF) <= high <= longest(spec) * (1 + OFF):
        return None
    if len(edges) > 1:
        raise StudyError(
            f'from and to are places along one edge, and {", ".join(edges)} are clamped; add support = "{edges[0]}"'
        )
    if not -OFF * size <= low <= high <= (1 + OFF) * size:
        raise StudyError(
            f"from = {low:g} m, to = {high:g} m is not a stretch of the edge {edges[0]}, from 0 to {size:g} m"
        )
    return max(low, 0.0), min(high, size)


def released_edges(spec: Spec, values: Values) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the clamped edges that give way, and those that hold.

    Raises
    ------
    StudyError
        If the one that is named is not clamped.
    """
    clamped, named = tuple(spec.clamped), str(values.get("support", ALL))
    if named == ALL:
        return clamped, ()
    if named not in clamped:
        raise StudyError(
            f"support = {named!r} is not a clamped edge; those are {', '.join(clamped) or 'none'}"
        )
    return (named,), tuple(edge for edge in clamped if edge != named)
