"""The squared slope of a jump of potential along one side of a plate, integrated short of its open edges."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from acquisition.arrays import FloatArray, frozen_array

_EXTRA = 24


@lru_cache(maxsize=64)
def slip_gram(length: float, count: int, cut: float, *, half: bool) -> FloatArray:
    """Return the matrix that integrates the squared slope of values at collocation points.

    Parameters
    ----------
    length : float
        Of the side [m].
    count : int
        Collocation points, even in the angle [-].
    cut : float
        Where the integral stops short of an open edge [m].
    half : bool
        Whether the start is no edge but a plane of symmetry.

    Returns
    -------
    (count, count) array
        Symmetric [1/m].

    Notes
    -----
    The values are those of a sum of sin(p t), where x = length (1 - cos t) / 2 from an edge. Squared slopes
    p q cos(p t) cos(q t) / (length sin(t) / 2) are integrated in u = ln tan(t / 2), in which they are smooth.
    """
    whole, number = (2 * length, 2 * count) if half else (length, count)
    orders = np.arange(1, number + 1)
    angles = (np.arange(number) + 0.5) * np.pi / number
    first = np.arccos(1.0 - 2 * cut / whole)
    end = -np.log(np.tan(0.5 * first))
    points, weights = np.polynomial.legendre.leggauss(4 * number + _EXTRA)
    t = 2 * np.arctan(np.exp(end * points))
    slopes = orders * np.cos(np.outer(t, orders)) * np.sqrt(2 * end * weights / whole)[:, None]
    fitted = np.linalg.solve(np.sin(np.outer(angles, orders)).T, slopes.T).T
    if half:
        fitted = (fitted[:, count:] + fitted[:, count - 1 :: -1]) * np.sqrt(0.5)
    return frozen_array(fitted.T @ fitted)
