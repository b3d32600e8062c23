"""Nodes of imported matrices at which something may sit: test points and node sets, and all others."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from acquisition.arrays import FloatArray, IntArray
from updating.effects.obstacles import Lack, Obstacle
from updating.models.imported.groups import Group
from updating.models.imported.matrices import Imported
from updating.prediction.predict import Predictor

NAMED_SHARE = 0.5
"""Prior share of the places that a user named, test points and node sets, the rest that of all other nodes [-]:
judged. Doubled, nothing sits between them."""

SAME = 1e-6
"""So near to each other, of the structure's size, two places are one [-]."""


def distinct(imported: Imported, places: FloatArray, others: FloatArray) -> IntArray:
    """Return the indices of places (n, 3) that are none of the others (m, 3) [m]."""
    if not len(others):
        return np.arange(len(places))
    away, _ = KDTree(others).query(places)
    return np.flatnonzero(away > SAME * imported.reach)


def distinct_groups(imported: Imported) -> tuple[Group, ...]:
    """Return the node sets that are places, of the two sides of a joint that the matrices tie the first alone."""
    tied = {joint.sides[1] for joint in imported.joints if joint.stiffness[0] > 0}
    return tuple(group for group in imported.groups if group.name not in tied)


def group_centres(imported: Imported) -> FloatArray:
    """Return the middles of the node sets that are places, (n, 3) [m]."""
    return np.array([group.centre for group in imported.groups]).reshape(-1, 3)


def free_nodes(imported: Imported, known: FloatArray) -> IntArray:
    """Return the nodes that move and are at none of the known places (n, 3) [m], of several at one place the first."""
    places = imported.places
    moving = np.flatnonzero(sum(np.asarray(m.sum(axis=1)).ravel() for m in places.moves) > 0)
    _, first = np.unique(np.round(places.at[moving] / (SAME * imported.reach)), axis=0, return_index=True)
    unlike = moving[np.sort(first)]
    found: IntArray = unlike[distinct(imported, places.at[unlike], known)]
    return found


def without_places(predictor: Predictor, what: str) -> Obstacle | None:
    """Return the obstacle of imported matrices on which there is no place at which something is or acts."""
    imported = predictor.spec.imported
    if imported is None or len(predictor.measured.points) or imported.groups:
        return None
    return Obstacle(Lack.DATA, f"imported matrices need points of the test, or node sets, at which {what}")
