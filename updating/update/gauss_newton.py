"""What the iterations of both updates, by frequencies and by FRFs, have in common: Gauss-Newton within bounds.

A step is the least-squares solution of the linearised problem, by singular values: directions that nothing determines
stay where they are. A parameter at a bound that the step would push further stays there, and the others step as if it
were known. A step is halved until the misfit falls.

``scipy.optimize.least_squares`` solves such problems, too. It has no place for what these iterations have: weights that
follow the model, a choice between two sensitivities of one step, singular values cut off at the noise, a secant of the
residuals' curvature, and a second-order correction behind a step; and it asks for residuals and sensitivities apart,
where one evaluation of a model gives both. The diagnosis maximises a likelihood whose noise depends on the parameters,
which is no sum of squares: see :mod:`updating.diagnosis.search.fit`.

References
----------
Gauss-Newton steps by singular values, and steps that are halved: Nocedal and Wright, Numerical Optimization, 2nd ed.
(2006), chapters 3 and 10. Parameters held at bounds that the step pushes against: Bertsekas, SIAM J. Control Optim. 20
(1982) 221-246; here they are held by the sign of the step, not of the gradient, and let go at the next step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from acquisition.arrays import BoolArray, FloatArray

NEGLIGIBLE = 1e-10
"""Singular values under this share of the largest carry nothing [-]."""

_Result = TypeVar("_Result")


def strong(size: FloatArray, floor: float = 0.0) -> BoolArray:
    """Return which singular values carry anything, and are above a floor, (n,)."""
    return np.asarray(size > max(floor, NEGLIGIBLE * float(size.max(initial=0.0))))


def least_squares_step(rows: FloatArray, load: FloatArray, floor: float = 0.0) -> FloatArray:
    """Return the shortest x (p,) for which rows x is nearest to load, without directions that carry nothing.

    Parameters
    ----------
    rows : (n, p) array
        Whitened sensitivities.
    load : (n,) array
        Whitened residuals.
    floor : float
        Singular value up to which a direction stays, too.
    """
    if rows.shape[1] == 0:
        return np.zeros(0)
    left, size, right = np.linalg.svd(rows, full_matrices=False)
    kept = strong(size, floor)
    return np.asarray(right[kept].T @ ((left[:, kept].T @ load) / size[kept]))


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
    for _ in range(len(theta)):  # every round holds at least one parameter more
        increment = np.zeros(len(theta))
        increment[free] = step(free)
        out = free & (((theta <= low + tiny) & (increment < 0)) | ((theta >= high - tiny) & (increment > 0)))
        if not out.any():
            break
        free = free & ~out
    return np.where(free, increment, 0.0)


def halved(
    attempt: Callable[[FloatArray], _Result | None],
    theta: FloatArray,
    step: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    *,
    smallest: FloatArray,
    most: int,
) -> _Result | None:
    """Return the first success of a step that is halved until it has one; None where it has none.

    Parameters
    ----------
    attempt : callable
        Returns what came of coordinates (p,), None where the misfit does not fall.
    theta, step : (p,) arrays
        Coordinates and the whole step.
    bounds : pair of (p,) arrays
        Lower and upper bounds of the coordinates.
    smallest : (p,) array
        Move of each coordinate that is not worth a further try.
    most : int
        Largest number of tries.
    """
    for halving in range(most):
        new = np.clip(theta + step / 2**halving, *bounds)
        found = attempt(new)
        if found is not None:
            return found
        if np.all(np.abs(new - theta) <= smallest):
            break
    return None
