"""Steps of parameters that have bounds: what is at a bound and would be pushed further stays there."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from acquisition.arrays import BoolArray, FloatArray


def bounded_step(
    step: Callable[[BoolArray], FloatArray], theta: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Return a step after which no parameter is pushed beyond its bound; the others step as if these were known.

    Parameters
    ----------
    step : callable
        Step of the free parameters, of a mask (p,) of those that are free.
    theta, low, high : (p,) arrays
        Coordinates and their bounds.
    """
    free, increment = np.ones(len(theta), dtype=bool), np.zeros(len(theta))
    tiny = 1e-9 * (high - low)
    for _ in range(len(theta)):
        increment = np.zeros(len(theta))
        increment[free] = step(free)
        out = free & (((theta <= low + tiny) & (increment < 0)) | ((theta >= high - tiny) & (increment > 0)))
        if not out.any():
            break
        free = free & ~out
    return np.where(free, increment, 0.0)
