"""Places on a specimen at which something may be done: test points, or a coarse grid."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import place as written
from updating.diagnosis.next_test.base import Site
from updating.models.spec import Spec
from updating.problem.specimen import SpecimenProblem


def grid(spec: Spec) -> FloatArray:
    """Return places spread over a structure, (n, dim) [m]: five along it, and on a plate both edges and the middle.

    Torsion shows at the edges, and does not in the middle.
    """
    along, across = np.array([0.2, 0.4, 0.6, 0.8, 1.0]), np.array([0.05, 0.5, 0.95])
    if spec.clamped == ("x1",):
        along = 1 - along
    if spec.kind == "beam":
        return (spec.length * along)[:, None]
    x, y = np.meshgrid(spec.length * along, spec.width * across, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=1)


def in_liquid(problem: SpecimenProblem, *, thin: float = 10.0) -> bool | None:
    """Return whether a specimen is stated to be in a liquid; None where nothing is stated.

    A fluid less dense than ``thin`` [kg/m^3] is a gas: air has 1.2, light oils 700.
    """
    around = problem.predictor.environment.fluid_density
    return None if around is None else around >= thin


def telling_places(problem: SpecimenProblem, *, most: int = 4) -> FloatArray:
    """Return where a mass would act on the modes the most, and the least alike, ``most`` places, (n, dim) [m]."""
    spec, points = problem.predictor.spec, problem.measured.points
    if not len(points):
        if not spec.outlined:
            return np.zeros((0, 3))
        points = grid(spec)
    points = np.unique(points, axis=0)
    vectors = problem.nominal.vectors
    rows = problem.predictor.reduced.rows(points)["w"][:, : len(vectors)] @ vectors
    moved = np.abs(rows) / np.maximum(np.abs(rows).max(axis=0), 1e-300)
    first = int(np.argmax(moved.sum(axis=1)))
    chosen = [first]
    while len(chosen) < min(most, len(points)):
        direction = moved[chosen].T
        left = moved - (moved @ np.linalg.pinv(direction).T) @ direction.T
        left[chosen] = 0.0
        chosen.append(int(np.argmax(np.linalg.norm(left, axis=1))))
    return points[list(dict.fromkeys(chosen))]


def place_text(site: Site, place: FloatArray) -> str:
    """Return how a place is called: the number of a test point there, or its coordinates."""
    test = site.problem.measured
    if len(test.points):
        away = np.linalg.norm(test.points - place, axis=1)
        if away.min() < 1e-6:
            return f"point {test.nodes[int(np.argmin(away))]}"
    return written(place.tolist(), plate=len(place) > 1)
