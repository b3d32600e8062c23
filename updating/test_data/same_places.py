"""Which points of a test were points of its baseline: by where they are, whatever their numbers."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import quantity
from updating.test_data.measured import Measured

APART = 3.0
"""Standard deviations of the two places up to which two points are one [-]."""

LEAST = 1e-6
"""So near to each other, relative to the structure, two points are one however well they are known [-]."""

ALIGNED = 0.99
"""Cosine between the directions of two points from which they move alike [-]."""

NAMED = 5
"""So many points are named in a warning."""


def same_points(test: Measured, baseline: Measured) -> IntArray:
    """Return which point of the baseline each point of a test is, (n_points,); -1 for none."""
    if not len(test.points) or not len(baseline.points):
        return np.full(len(test.points), -1)
    distance = np.linalg.norm(test.points[:, None, :] - baseline.points[None, :, :], axis=2)
    if test.directions is not None and baseline.directions is not None:
        distance = np.where(test.directions @ baseline.directions.T > ALIGNED, distance, np.inf)
    nearest = np.argmin(distance, axis=1)
    near = distance[np.arange(len(nearest)), nearest] <= reach(test, baseline)
    return np.asarray(np.where(near, nearest, -1))


def reach(test: Measured, baseline: Measured) -> float:
    """Return how far apart two points may be stated and still be one [m]."""
    size = float(np.ptp(np.concatenate([test.points, baseline.points]), axis=0).max(initial=0.0))
    return max(APART * float(np.hypot(test.position_sigma, baseline.position_sigma)), LEAST * size)


def same_rows(test: Measured, baseline: Measured) -> tuple[IntArray, IntArray]:
    """Return rows of a test and of its baseline with the same two points, in either order, each (n,)."""
    twin = same_points(test, baseline)
    there = {
        frozenset((int(a), int(b))): row
        for row, (a, b) in enumerate(zip(baseline.seen, baseline.hit, strict=True))
        if b >= 0
    }
    pairs = []
    for row, (a, b) in enumerate(zip(test.seen, test.hit, strict=True)):
        if b >= 0 and (key := frozenset((int(twin[a]), int(twin[b])))) in there:
            pairs.append((row, there[key]))
    rows = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return rows[:, 0], rows[:, 1]


def unmatched(test: Measured, baseline: Measured) -> tuple[str, ...]:
    """Return what to say of FRFs of a test that its baseline does not have."""
    if not (test.absolute and baseline.absolute) or test.bare or baseline.bare:
        return ()
    here, _ = same_rows(test, baseline)
    lost = np.setdiff1d(np.arange(len(test.seen)), here)
    if not len(lost):
        return ()
    alone = same_points(test, baseline) < 0
    touched = np.unique([*test.seen[lost], *test.hit[lost]])
    nodes = sorted({test.nodes[p] for p in touched[alone[touched]].tolist()})
    named = ", ".join(map(str, nodes[:NAMED])) + (", ..." if len(nodes) > NAMED else "")
    where = _where(test, baseline, nodes)
    which = (
        f"point(s) {named} are not among its points{where}"
        if nodes
        else "its FRFs connect other pairs of points"
    )
    return (
        f"{len(lost)} of the test's {len(test.seen)} FRFs were not measured in it: {which}. The errors of the model's "
        "shapes there remain unknown",
    )


def _where(test: Measured, baseline: Measured, nodes: list[int]) -> str:
    """Return how far a point lies from the one with its number, where there is one."""
    for node in nodes:
        if node in baseline.nodes:
            away: FloatArray = (
                test.points[test.nodes.index(node)] - baseline.points[baseline.nodes.index(node)]
            )
            return f" (number {node} lies {quantity(float(np.linalg.norm(away)), 'm')} from its place in the baseline)"
    return f" (none lies within {quantity(reach(test, baseline), 'm')})"
