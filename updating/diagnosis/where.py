"""Where the cause sits: which channel, which place, which points."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem import Problem
from updating.diagnosis.result import Place, Where, Zone
from updating.diagnosis.search import Search, Weighed
from updating.models import Region

CHANNELS = ("stiffness", "mass", "damping", "measurement")


def locate(problem: Problem, found: Search, *, significant: bool) -> Where:
    """Say where the cause sits, averaged over all explanations by their probability.

    Parameters
    ----------
    problem : Problem
        Test and model.
    found : Search
        What was weighed.
    significant : bool
        Whether there is a gap at all; if not, the channel is ``none``.
    """
    channels = dict.fromkeys(CHANNELS, 0.0)
    nothing = 0.0
    for row in found.weighed:
        acting = [effect.channel for effect in row.explanation.candidate.effects]
        for name in acting:
            channels[name] += row.probability / len(acting)
        nothing += row.probability if not acting else 0.0
    explained = sum(channels.values())
    shares = {n: float(v / explained) if explained > 0 else 0.0 for n, v in channels.items()}
    top = max(shares, key=lambda n: shares[n])
    if not significant:
        return Where("none", {**shares, "none": nothing}, None, (), (), _zones(problem, found))
    leader = next((row for row in found.weighed if row.names), None)
    places = () if leader is None else _places(problem, leader, top)
    return Where(
        top,
        {**shares, "none": nothing},
        places[0] if places else None,
        places,
        _points(problem, leader, places),
        _zones(problem, found),
    )


def _places(problem: Problem, row: Weighed, channel: str) -> tuple[Place, ...]:
    """Return where the effects of a channel sit, of all effects if none of it has a place."""
    explanation = row.explanation
    candidate, coordinates = explanation.candidate, explanation.best.coordinates.tolist()
    places = candidate.locations(problem.predictor, coordinates, channel=channel)
    places = places or candidate.locations(problem.predictor, coordinates)
    return tuple((float(p[0]), float(p[1]), float(p[2])) for p in places)


def _points(problem: Problem, leader: Weighed | None, places: tuple[Place, ...]) -> tuple[int, ...]:
    """Return the test nodes at the places, within a twentieth of the length."""
    if leader is None or not places or not len(problem.measured.points):
        return ()
    points = problem.measured.points
    reach = 0.05 * problem.predictor.spec.length
    found = []
    for place in places:
        distance = np.linalg.norm(points - np.array(place[: points.shape[1]]), axis=1)
        if distance.min() <= reach:
            found.append(problem.measured.nodes[int(np.argmin(distance))])
    return tuple(dict.fromkeys(found))


def _zones(problem: Problem, found: Search) -> tuple[Zone, ...]:
    """Spread each explanation over the regions: a seated one by its place, any other by area."""
    regions = problem.predictor.spec.regions
    area = np.array([_area(region, problem.predictor.spec.width) for region in regions])
    even = area / area.sum()
    total = np.zeros(len(regions))
    for row in found.weighed:
        if not row.names:
            continue
        total += row.probability * _spread(problem, row, even)
    if total.sum() > 0:
        total = total / total.sum()
    return tuple(
        Zone(region.name, _centre(region, problem.predictor.spec.width), float(p))
        for region, p in zip(regions, total, strict=True)
    )


def _spread(problem: Problem, row: Weighed, even: FloatArray) -> FloatArray:
    explanation = row.explanation
    regions = problem.predictor.spec.regions
    heavy = np.argsort(explanation.weights)[::-1][:200]
    share = np.zeros(len(regions))
    for index in heavy:
        places = explanation.candidate.locations(problem.predictor, explanation.samples[index].tolist())
        if not places:
            return even
        for place in places:
            share[_region_at(regions, place)] += explanation.weights[index] / len(places)
    return np.asarray(share / max(share.sum(), 1e-300))


def _region_at(regions: tuple[Region, ...], place: Place) -> int:
    """Return the region that holds a place, or the nearest one."""

    def distance(region: Region) -> float:
        away = max(region.x[0] - place[0], 0.0, place[0] - region.x[1])
        if region.y is None:
            return away
        return float(np.hypot(away, max(region.y[0] - place[1], 0.0, place[1] - region.y[1])))

    return int(np.argmin([distance(region) for region in regions]))


def _area(region: Region, width: float) -> float:
    return (region.x[1] - region.x[0]) * (width if region.y is None else region.y[1] - region.y[0])


def _centre(region: Region, width: float) -> Place:
    y = (0.0 if region.y is None else sum(region.y) / 2) if region.y is not None else 0.0
    return (float(sum(region.x) / 2), float(y), 0.0)
