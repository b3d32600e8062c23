"""Where else a structure might be hit or seen: places spread over it, each along the axis on which it moves most."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import place as written
from updating.models import Spec
from updating.prediction.predict import Predictor

SPREAD = 12
"""So many places are tried [-]."""

ALONG = 41
"""Places along a beam among which these are chosen [-]."""

CLOSE = 0.02
"""Nearer to a point of the test than this share of the structure, a place is no other one [-]."""

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Spot:
    """A place and a direction.

    Parameters
    ----------
    place : (3,) array
        In model axes [m].
    axis : int
        0, 1, 2 along x, y, z.
    name : str
        How it is called.
    """

    place: FloatArray
    axis: int
    name: str


def candidates(predictor: Predictor, ranks: IntArray, points: FloatArray) -> tuple[Spot, ...]:
    """Return places that are far from the test's points and from each other, as far as they move.

    Parameters
    ----------
    predictor : Predictor
        The model.
    ranks : (n_modes,) int array
        The modes that are seen.
    points : (n_points, dim) array
        Points of the test [m].
    """
    spec = predictor.spec
    places = _grid(spec) if spec.imported is None else spec.imported.places.at
    vectors = predictor.predict(count=int(ranks.max()) + 1).vectors[:, ranks]
    moved = _moved(predictor, places, vectors)
    able = np.flatnonzero(moved.max(axis=1) > CLOSE * moved.max())
    chosen = _spread(places[able], points, spec)
    return tuple(
        Spot(_full(places[i]), int(moved[i].argmax()), _name(predictor, places[i], int(moved[i].argmax())))
        for i in able[chosen]
    )


def _grid(spec: Spec) -> FloatArray:
    """Return places along a beam (n, 1) or over a plate, off its edges by a twentieth, (n, 2) [m]."""
    if spec.kind == "beam":
        return spec.length * np.linspace(0.0, 1.0, ALONG)[:, None]
    x, y = np.meshgrid(np.linspace(0.05, 0.95, 9), np.linspace(0.05, 0.95, 6), indexing="ij")
    return np.stack([spec.length * x.ravel(), spec.width * y.ravel()], axis=1)


def _full(place: FloatArray) -> FloatArray:
    return np.concatenate([place, np.zeros(3 - len(place))])


def _moved(predictor: Predictor, places: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return how much places move along x, y and z, over all modes, each over its own largest motion, (n, 3) [-]."""
    imported = predictor.spec.imported
    if imported is None:
        along = np.abs(predictor.reduced.rows(places)["w"][:, : len(vectors)] @ vectors)
        found = np.zeros((len(places), 3))
        found[:, 2] = (along / np.maximum(along.max(axis=0), 1e-300)).sum(axis=1)
        return found
    full = predictor.reduced.basis[:, : len(vectors)] @ vectors
    shapes = np.stack([np.abs(move @ full) for move in imported.places.moves], axis=1)
    return np.asarray((shapes / np.maximum(shapes.max(axis=(0, 1)), 1e-300)).sum(axis=2))


def _spread(places: FloatArray, points: FloatArray, spec: Spec) -> list[int]:
    """Return places one after the other, each the farthest from all before it and from the points of the test."""
    size = max(spec.length, spec.width, spec.thickness if spec.imported is not None else 0.0)
    start = points if len(points) else places.mean(axis=0, keepdims=True)
    away = np.min(np.linalg.norm(places[:, None] - start[None], axis=2), axis=1)
    chosen: list[int] = []
    while len(chosen) < SPREAD and away.max(initial=0.0) > CLOSE * size:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, np.linalg.norm(places - places[chosen[-1]], axis=1))
    return chosen


def _name(predictor: Predictor, place: FloatArray, axis: int) -> str:
    """Return the node, where it is and in which region, and along what it is hit."""
    spec = predictor.spec
    at = written(place.tolist(), plate=spec.kind != "beam")
    if spec.imported is None:
        return at if spec.kind == "beam" else f"({at})"
    places = spec.imported.places
    node = int(places.node[np.linalg.norm(places.at - place, axis=1).argmin()])
    region = _region(spec, place)
    return f"node {node} along {AXES[axis]} ({at}{f', {region}' if region else ''})"


def _region(spec: Spec, place: FloatArray) -> str:
    """Return the smallest region in whose box a place lies, "" where there is none."""
    assert spec.imported is not None
    found: list[tuple[float, str]] = []
    slack = 1e-6 * spec.imported.reach
    for index, region in enumerate(spec.regions):
        box = spec.imported.box(index)
        if box is not None and (place >= box[0] - slack).all() and (place <= box[1] + slack).all():
            found.append((float(np.prod(box[1] - box[0] + slack)), region.name))
    return min(found)[1] if found else ""
