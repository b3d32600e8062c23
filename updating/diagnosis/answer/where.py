"""Where the cause sits: which modes, which channel, which place, which points, which regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.answer.clusters import Cluster, clusters, sampled_places
from updating.diagnosis.answer.contributions import Contributions, contributions
from updating.diagnosis.answer.located import LikelyPlace, Where, Zone
from updating.diagnosis.answer.result import Verdict
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.search.compared import Compared, Search
from updating.effects.base import Values
from updating.effects.box import LIKE, Place
from updating.effects.measurement.points import channel_point
from updating.effects.regions import named_places
from updating.localisation import areas, centres, compare_regions, regions_at
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import NEGLIGIBLE_PROBABILITY

CHANNELS = ("stiffness", "mass", "damping", "measurement")

LABELS = (".point", ".points", ".channel")
"""Endings of parameters that name points of the test."""


def locate(
    problem: SpecimenProblem,
    found: Search,
    *,
    verdict: Verdict,
    whole: Search | None = None,
    rules: DecisionRules = DEFAULT_RULES,
) -> Where:
    """State where the cause sits, averaged over all explanations by their probability.

    Parameters
    ----------
    problem : Problem
        Test and model.
    found : Search
        What was compared.
    verdict : {"named", "class", "unknown", "none"}
        With none, no gap, the channel is ``none``; where nothing is named, regions are compared by themselves.
    whole : Search, optional
        What was compared for several specimens, of which ``found`` holds what acts on this one.
    rules : DecisionRules
        What the answer is decided by.
    """
    shares, nothing = _channels(found if whole is None else whole)
    seen = contributions(problem)
    if verdict == "none":
        return _nowhere(problem, found, {**shares, "none": nothing}, seen)
    together = acting_together(shares, rules=rules)
    top = together[0]
    leader = next((row for row in found.compared if row.names), None)
    likely_places = () if leader is None else _likely_places(problem, leader, together, rules)
    places = tuple(_place(cluster.place) for _, cluster in likely_places)
    nearest = _nearest(problem, [cluster for _, cluster in likely_places], rules.concerned_reach)
    unknown = verdict == "unknown"
    probability = _by_regions(problem, top) if unknown else _by_explanations(problem, found)
    return Where(
        channel=top,
        channels={**shares, "none": nothing},
        location=places[0] if places else None,
        locations=places,
        points=_points(problem, leader) or nearest,
        zones=_zones(problem, probability),
        zones_by="regions" if unknown else "explanations",
        likely_places=tuple(
            LikelyPlace(_place(c.place), _place(c.spread), c.weight, name, c.likely_place)
            for name, c in likely_places
        ),
        modes=seen.modes,
        band=seen.summary,
        nearest=nearest,
        names=_names(leader),
    )


def _nowhere(
    problem: SpecimenProblem, found: Search, channels: dict[str, float], seen: Contributions
) -> Where:
    """Return what is stated of the place where there is no gap."""
    return Where(
        channel="none",
        channels=channels,
        location=None,
        locations=(),
        points=(),
        zones=_zones(problem, _by_explanations(problem, found)),
        modes=seen.modes,
        band=seen.summary,
    )


def _names(leader: Compared | None) -> tuple[str, ...]:
    """Return the regions, node sets, joints and supports that an explanation names."""
    if leader is None:
        return ()
    forms = leader.explanation.candidate.forms
    return tuple(dict.fromkeys(name for form in forms for name in named_places(form.values)))


def acting_together(shares: Mapping[str, float], *, rules: DecisionRules = DEFAULT_RULES) -> tuple[str, ...]:
    """Return the most probable channel, and those that act with it as halves of one pair, the structure's first.

    Parameters
    ----------
    shares : mapping
        Probability of each channel [-].
    rules : DecisionRules
        What the answer is decided by.
    """
    most = max(shares[name] for name in CHANNELS)
    return tuple(name for name in CHANNELS if shares[name] > most - rules.together_share)


def _likely_places(
    problem: SpecimenProblem, leader: Compared, channels: tuple[str, ...], rules: DecisionRules
) -> tuple[tuple[str, Cluster], ...]:
    """Return the places of an explanation in all channels that act together, each with its channel.

    On imported matrices places are forms of their own: what these data cannot separate from the best are places, too.
    """
    forms = [(leader.explanation, 1.0)]
    if not problem.predictor.spec.outlined:
        forms = [form for form in leader.forms if form[0].names == leader.names] or forms
    near, found = LIKE * problem.predictor.spec.length, list[tuple[str, Cluster]]()
    for explanation, share in forms:
        for name in channels:
            for cluster in clusters(problem, explanation, name, rules=rules):
                if all(np.linalg.norm(cluster.place - known.place) > near for _, known in found):
                    found.append((name, replace(cluster, weight=share * cluster.weight)))
    return tuple(found)


def _channels(found: Search) -> tuple[dict[str, float], float]:
    """Return the probability of each channel given that there is a cause, and that of none."""
    channels, nothing = dict.fromkeys(CHANNELS, 0.0), 0.0
    for row in found.compared:
        acting = [effect.channel for effect in row.explanation.candidate.effects]
        for name in acting:
            channels[name] += row.probability / len(acting)
        nothing += row.probability if not acting else 0.0
    explained = sum(channels.values())
    return {n: float(v / explained) if explained > 0 else 0.0 for n, v in channels.items()}, nothing


def _place(place: FloatArray) -> Place:
    return float(place[0]), float(place[1]), float(place[2])


def _points(problem: SpecimenProblem, leader: Compared | None) -> tuple[int, ...]:
    """Return the test nodes named by an effect of the measurement."""
    if leader is None:
        return ()
    explanation, test = leader.explanation, problem.measured
    values: Values = problem.values(explanation.candidate, explanation.best.coordinates)
    named = [v for name, v in values.items() if name.endswith(LABELS)]
    sensors = [test.nodes[channel_point(test, v)[1]] for v in named if isinstance(v, str)]
    nodes = [n for v in named if not isinstance(v, str) for n in np.atleast_1d(np.asarray(v)).tolist()]
    return tuple(dict.fromkeys(map(int, nodes + sensors)))


def _nearest(problem: SpecimenProblem, likely_places: Sequence[Cluster], reach: float) -> tuple[int, ...]:
    """Return the test nodes at the places."""
    test, spec = problem.measured, problem.predictor.spec
    if not likely_places or not len(test.points):
        return ()
    dim = test.points.shape[1]
    away = np.linalg.norm(
        np.stack([c.place[:dim] for c in likely_places])[:, None] - test.points[None], axis=2
    )
    near = away.min(axis=1) <= reach * max(spec.length, spec.width if dim > 1 else 0.0)
    return tuple(dict.fromkeys(test.nodes[int(i)] for i in away.argmin(axis=1)[near]))


def _zones(problem: SpecimenProblem, probability: FloatArray) -> tuple[Zone, ...]:
    regions, middle = problem.predictor.spec.regions, centres(problem)
    return tuple(
        Zone(region.name, _place(at), float(p))
        for region, at, p in zip(regions, middle, probability, strict=True)
    )


def _by_explanations(problem: SpecimenProblem, found: Search) -> FloatArray:
    """Spread each explanation over the regions: one that has places by these, any other by area."""
    even = areas(problem)
    total = np.zeros(len(even))
    for row in found.compared:
        if row.names and row.probability > NEGLIGIBLE_PROBABILITY:
            total += row.probability * _spread(problem, row, even)
    return np.asarray(total / total.sum() if total.sum() > 0 else even)


def _spread(problem: SpecimenProblem, row: Compared, even: FloatArray) -> FloatArray:
    explanation = row.explanation
    if row.regions:
        names = [region.name for region in problem.predictor.spec.regions]
        shares = np.array([row.regions.get(name, 0.0) / names.count(name) for name in names])
        return np.asarray(shares / shares.sum())
    sampled = sampled_places(problem, explanation)
    if not sampled.weights.sum() > 0:
        return even
    shares = regions_at(problem.predictor.spec, sampled.places)
    return np.asarray(sampled.weights @ shares / sampled.weights.sum())


def _by_regions(problem: SpecimenProblem, channel: str) -> FloatArray:
    """Return the probability of each region by the evidence of a change of it alone."""
    kinds = [kind for kind in ("stiffness", "mass", "damping") if channel in (kind, "measurement")]
    return compare_regions(problem.specimens[0], tuple(kinds)).regions  # type: ignore[arg-type]
