"""Values at scattered points as a surface."""

from __future__ import annotations

import math

import numpy as np

from acquisition.arrays import FloatArray


def grid_values(points: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Return x, y and the values between the points of a full rectangular grid, bilinear; None if it is none."""
    digits = 6 - math.floor(math.log10(max(float(np.ptp(points)), 1e-12)))
    (x, column), (y, row) = (np.unique(c.round(digits), return_inverse=True) for c in points.T)
    if len(x) < 2 or len(y) < 2 or len(points) != len(x) * len(y):
        return None
    table = np.full((len(y), len(x)), np.nan)
    table[row, column] = values
    if np.isnan(table).any():
        return None
    fine_x, fine_y = (np.interp(np.linspace(0, len(a) - 1, 61), np.arange(len(a)), a) for a in (x, y))
    along = np.array([np.interp(fine_x, x, line) for line in table])
    whole = np.array([np.interp(fine_y, y, line) for line in along.T]).T
    return fine_x, fine_y, whole


def spans(points: FloatArray) -> bool:
    """Return whether the points can be triangulated."""
    distinct = np.unique(points, axis=0)
    return len(distinct) >= 3 and bool(np.linalg.matrix_rank(distinct - distinct[0], tol=1e-9) == 2)
