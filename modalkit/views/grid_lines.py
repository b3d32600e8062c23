"""Lines between the points of a test whose file has none: neighbours in the rows of a grid."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from acquisition.arrays import FloatArray


def grid_lines(points: FloatArray, *, aligned: float = 0.02, gap: float = 2.5) -> list[tuple[int, int]]:
    """Return rows of ``points`` that are neighbours along an axis, each pair once.

    Points lie in a row along an axis if they differ along it alone. Neighbours in a row that are far apart are not
    joined: there is a hole.

    Parameters
    ----------
    points : (n, 3) array
        Places [m].
    aligned : float
        Largest distance of a point from its row, over the diagonal of all points [-].
    gap : float
        Largest distance of neighbours, over the median of all along that axis [-].
    """
    size = float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0
    if size == 0.0:
        return []
    found: list[tuple[int, int]] = []
    level = np.stack([_levels(points[:, axis], aligned * size) for axis in range(3)], axis=1)
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        _, row = np.unique(level[:, others], axis=0, return_inverse=True)
        order = np.lexsort((points[:, axis], row.ravel()))
        pairs = [
            (int(a), int(b))
            for a, b in pairwise(order)
            if row.ravel()[a] == row.ravel()[b] and level[a, axis] != level[b, axis]
        ]
        apart = np.array([points[b, axis] - points[a, axis] for a, b in pairs])
        found += [pair for pair, one in zip(pairs, apart, strict=True) if one <= gap * np.median(apart)]
    return found


def _levels(values: FloatArray, step: float) -> FloatArray:
    """Return the number of the level of each value, (n,): values within a step of the one below share it."""
    order = np.argsort(values)
    number = np.zeros(len(values))
    number[order[1:]] = np.cumsum(np.diff(values[order]) > step)
    return number
