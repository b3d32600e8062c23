"""At which level an answer is certain: the set of effects, or what several sets do alike.

Effects of two sets share a mechanism where they act in one channel, over one extent and at one place, in one direction,
and have a currency of their size in common. A set with more effects than another has the mechanisms of the other, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.answer.components import components
from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE, SomethingElse
from updating.diagnosis.answer.located import Where
from updating.diagnosis.answer.mechanism import (
    Alike,
    Component,
    Level,
    Levels,
    Mechanism,
    MechanismSize,
    Quantity,
)
from updating.diagnosis.answer.quantiles import quantiles
from updating.diagnosis.answer.result import Verdict
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.search.compared import Search
from updating.effects.box import Place
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True, eq=False)
class Holder:
    """A set of effects, or a cause in no library, with what it does.

    Parameters
    ----------
    effects : tuple of str
        Their names.
    probability : float
        Given that there is a cause [-].
    parts : tuple of Component
        What each does.
    """

    effects: tuple[str, ...]
    probability: float
    parts: tuple[Component, ...]


def levels(
    problem: SpecimenProblem,
    found: Search,
    where: Where,
    verdict: Verdict,
    sets: tuple[tuple[str, ...], ...],
    other: SomethingElse | None,
    *,
    whole: Search | None = None,
    rules: DecisionRules = DEFAULT_RULES,
) -> Levels:
    """Return the mechanisms of an answer, and the level at which it is certain.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model.
    found : Search
        What was compared.
    where : Where
        Its places.
    verdict : {"named", "class", "unknown", "none"}
        What was decided. Of ``unknown`` the mechanisms are those of a cause in no library, where that is the more
        probable; of ``none`` there are none.
    sets : tuple of tuple of str
        The sets of the answer.
    other : SomethingElse, optional
        A cause in no library.
    whole : Search, optional
        What was compared for several specimens, of which ``found`` holds what acts on this one, row by row.
    rules : DecisionRules
        What the answer is decided by.
    """
    unnamed = 0.0 if other is None else other.probability
    if verdict == "none" or (verdict == "unknown" and (unnamed < 0.5 or other is None or not other.parts)):
        return Levels()
    apart = rules.separate_places * max(problem.predictor.spec.length, _width(problem))
    holders = _holders(problem, found, found if whole is None else whole, 1 - unnamed, apart)
    if other is not None and other.parts:
        holders.append(Holder((SOMETHING_ELSE,), unnamed, other.parts))
    named = verdict != "unknown"
    wanted = sets[0] if named else (SOMETHING_ELSE,)
    lead = next((one for one in holders if one.effects == wanted), None)
    if lead is None:
        return Levels()
    certain = {} if other is None else dict(other.channels)
    mechanisms = [
        mechanism(part, holders, where, apart, certain, enough=rules.credible_share) for part in lead.parts
    ]
    mechanisms.sort(key=lambda one: (-round(one.probability, 3), named and one.channel != where.channel))
    return Levels(_level(mechanisms[0], verdict, sets, rules), tuple(mechanisms))


def _level(
    leading: Mechanism, verdict: Verdict, sets: tuple[tuple[str, ...], ...], rules: DecisionRules
) -> Level | None:
    if verdict == "named":
        return "story"
    shared = {one.effects for one in leading.sets}
    sure = leading.probability >= rules.credible_share and shared.issuperset(sets)
    return "mechanism" if sure else None


def _width(problem: SpecimenProblem) -> float:
    return problem.predictor.spec.width if problem.predictor.spec.kind != "beam" else 0.0


def _holders(
    problem: SpecimenProblem,
    found: Search,
    whole: Search,
    share: float,
    apart: float,
    *,
    notable: float = 1e-2,
    least: float = 1e-3,
) -> list[Holder]:
    """Return the sets with ``least`` of the probability or more, those with less than ``notable`` by fewer samples."""
    every = zip(whole.compared, found.compared, strict=True)
    rows = [(one.names, row) for one, row in every if one.names]
    total = max(sum(row.probability for _, row in rows), 1e-300)
    return [
        Holder(
            names,
            share * row.probability / total,
            components(problem, row, apart=apart, most=300 if row.probability > notable * total else 40),
        )
        for names, row in rows
        if row is rows[0][1] or row.probability > least * total
    ]


def mechanism(
    part: Component,
    holders: Sequence[Holder],
    where: Where,
    apart: float,
    certain: Mapping[str, float],
    *,
    least: float = 1e-4,
    enough: float = DEFAULT_RULES.credible_share,
) -> Mechanism:
    """Return what a part of one set does, with all sets that do so.

    Parameters
    ----------
    part : Component
        What one effect of the leading set does.
    holders : sequence of Holder
        All sets, the leading one among them.
    where : Where
        Places of the leading set.
    apart : float
        Places this near to each other are one [m].
    certain : mapping of str to float
        Probability of each channel where the cause is in no library [-].
    least : float
        Sets with less of the probability are left out [-].
    enough : float
        Share of these sets that a currency of the size must have [-].
    """
    shared: list[tuple[Holder, Component, float]] = []
    for holder in holders:
        like = next((one for one in holder.parts if one is part or alike(part, one, apart)), None)
        if like is not None:
            sure = certain.get(like.channel, 1.0) if holder.effects == (SOMETHING_ELSE,) else 1.0
            share = sure * holder.probability
            if like is part or share >= least:
                shared.append((holder, like, share))
    shared.sort(key=lambda one: -one[2])
    _, middle, _ = map(_place, _interval(part))
    low, _, high = map(_place, _pooled([(one, share) for _, one, share in shared]))
    locations = _locations(part, middle, where, apart)
    return Mechanism(
        channel=part.channel,
        extent=part.extent,
        location=locations[0] if locations else None,
        locations=locations,
        location_low95=low,
        location_high95=high,
        size=_size(part, [(one, share) for _, one, share in shared], enough),
        probability=min(sum(share for _, _, share in shared), 1.0),
        sets=tuple(Alike(holder.effects, share) for holder, _, share in shared),
    )


def alike(one: Component, other: Component, apart: float) -> bool:
    """Return whether two components are one mechanism.

    Parameters
    ----------
    one, other : Component
        What two effects do.
    apart : float
        Places this near to each other are one, and those whose 95 % intervals meet [m].
    """
    placed = {"local", "edge"}
    if one.channel != other.channel or (one.extent != other.extent and {one.extent, other.extent} != placed):
        return False
    common = one.sizes.keys() & other.sizes.keys()
    if bool(common) != bool(one.sizes or other.sizes):
        return False
    if any(_median(one, size) * _median(other, size) < 0 for size in common):
        return False
    if (one.places is None) != (other.places is None) or one.count != other.count:
        return False
    if one.places is None or other.places is None:
        return True
    (low, a, high), (low_other, b, high_other) = _interval(one), _interval(other)
    gap = np.maximum(low - high_other, low_other - high)
    return bool(np.linalg.norm(a - b) <= apart or (gap <= 0).all())


def _median(part: Component, size: Quantity) -> float:
    return quantiles(part.sizes[size], part.weights)[1]


def _size(part: Component, shared: Sequence[tuple[Component, float]], enough: float) -> MechanismSize | None:
    """Return the size over the sets that share it, each with its share, in a currency that ``enough`` of them have.

    It is the first of those of the leading set.
    """
    kept = [(one, max(share, 1e-300)) for one, share in shared]
    total = sum(share for _, share in kept)
    held = {size: sum(share for one, share in kept if size in one.sizes) / total for size in part.sizes}
    name = next((size for size, share in held.items() if share >= enough), None)
    if name is None:
        return None
    kept = [(one, share) for one, share in kept if name in one.sizes]
    values = np.concatenate([one.sizes[name] for one, _ in kept])
    weights = np.concatenate([share * one.weights for one, share in kept])
    low, middle, high = quantiles(values, weights)
    doubt = max((one.doubts or {}).get(name, 0.0) for one, _ in kept)
    low, high = (
        middle + side * float(np.hypot(end - middle, 1.96 * doubt * middle))
        for side, end in ((-1, low), (1, high))
    )
    return MechanismSize(*name, middle, low, high)


def _locations(part: Component, middle: Place | None, where: Where, apart: float) -> tuple[Place, ...]:
    """Return the places of a part, with those of the answer that are alternatives to it, or taken with it."""
    if middle is None:
        return ()
    own = [one for one in where.likely_places if one.channel == part.channel]
    near = [one for one in own if np.linalg.norm(np.subtract(one.place, middle)) <= apart]
    if not near:
        return (middle,)
    chosen = own if part.count > 1 else [one for one in own if one.which == near[0].which]
    return tuple(one.place for one in chosen)


def _pooled(shared: Sequence[tuple[Component, float]]) -> FloatArray:
    """Return the interval and the median of the place over all sets, each with its share, as of one."""
    placed = [(one, max(share, 1e-300)) for one, share in shared if one.places is not None]
    if not placed:
        return np.full((3, 3), np.nan)
    weights = np.concatenate([share * one.weights for one, share in placed])
    places = np.concatenate([one.places for one, _ in placed if one.places is not None])
    first = placed[0][0]
    return _interval(Component(first.channel, first.extent, weights, {}, places))


def _interval(part: Component) -> FloatArray:
    """Return the ends of the 95 % interval and the median of each coordinate, (3, 3) [m]; nan of what has no place."""
    if part.places is None:
        return np.full((3, 3), np.nan)
    here = np.isfinite(part.places).all(axis=1)
    low, middle, high = zip(
        *(quantiles(axis, part.weights[here]) for axis in part.places[here].T), strict=True
    )
    return np.array([low, middle, high])


def _place(at: FloatArray) -> Place | None:
    """Return a place, None of nan."""
    x, y, z = at.tolist()
    return (x, y, z) if np.isfinite(at).all() else None
