"""A test with more points, or with the shapes that a test so far lacks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.next_test.base import Maker, Rival, Site, Trial
from updating.diagnosis.next_test.places import grid, place_text
from updating.diagnosis.next_test.repeat import Repeat
from updating.effects.structure.sensors import sensor_places
from updating.problem.specimen import SpecimenProblem
from updating.test_data.measured import Measured

NOT_YET = -1
"""Node number of a point that the test does not have yet."""


class FurtherPoint(Repeat):
    """One more point."""

    family = "further point"
    cost = 5

    def __init__(self, site: Site, place: FloatArray) -> None:
        """Take a place [m]."""
        self.measure = f"measure at one more point, {place_text(site, place)}"
        self.place = place

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem with the point among the others."""
        problem = site.problem
        return _with(problem, _one_more(problem.measured, self.place))


def _one_more(test: Measured, place: FloatArray) -> Measured:
    new = len(test.points)
    roving = len(set(test.seen.tolist())) > len(set(test.hit.tolist()))
    bare = bool((test.hit < 0).all())
    seen = new if roving or bare else int(test.seen[0])
    hit = -1 if bare else (int(test.hit[0]) if roving else new)
    size = np.sqrt(np.mean(test.constants**2, axis=0, keepdims=True))
    sigma = np.median(test.constants_sigma, axis=0, keepdims=True)
    return replace(
        test,
        points=np.vstack([test.points, place]),
        nodes=(*test.nodes, NOT_YET),
        seen=np.append(test.seen, seen),
        hit=np.append(test.hit, hit),
        constants=np.vstack([test.constants, size]),
        unpaired=None,
        constants_sigma=np.vstack([test.constants_sigma, sigma]),
        channel_group=None
        if test.channel_group is None
        else np.append(test.channel_group, test.channel_group[0]),
        noise=None,
        shared=None,
        hit_errors=None,
        quadrature=None,
        trend=None,
        trend_sigma=None,
        trusted=None,
        rows=None,
        signs=None,
    )


class Shapes(Repeat):
    """A hammer test with shapes, and calibrated level, of a specimen of which only frequencies are known."""

    family = "shapes"
    cost = 6
    same_chain = False

    def __init__(self, site: Site) -> None:
        """Choose the points."""
        self.places = grid(site.problem.predictor.spec)
        self.measure = (
            f"a hammer test at {len(self.places)} points with calibrated channels: shapes, and the level of the FRFs "
            "to 2 %"
        )

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem with FRFs from all points to the sensor."""
        problem, count = site.problem, len(self.places)
        at = sensor_places(problem.predictor)
        corner = at[:1] if len(at) else self.places[-1:]
        modes = len(problem.measured.frequency)
        data = replace(
            problem.measured,
            points=np.vstack([self.places, corner]),
            nodes=(NOT_YET,) * (count + 1),
            seen=np.full(count, count),
            hit=np.arange(count),
            constants=np.ones((count, modes)),
            unpaired=None,
            constants_sigma=np.full((count, modes), self.unknown_shape_noise),
            hit_errors=None,
            quadrature=None,
            absolute=True,
            repeated=True,
            trusted=None,
        )
        return _with(problem, data)


def _with(problem: SpecimenProblem, data: Measured) -> SpecimenProblem:
    return replace(problem, measured=data, predictor=problem.predictor.for_test(data))


class OtherPoints(Maker):
    """The further points that a specimen admits, or the shapes it lacks."""

    away = 0.04
    """Further points are at least this share of the length away from those there are [-]: nearer ones give the same
    information.
    """

    def trials(self, site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
        """Give them."""
        problem = site.problem
        spec, test = problem.predictor.spec, problem.measured
        if not spec.outlined:
            return
        if not test.has_shapes:
            yield Shapes(site)
            return
        for place in grid(spec):
            if np.linalg.norm(test.points - place, axis=1).min() > self.away * spec.length:
                yield FurtherPoint(site, place)
