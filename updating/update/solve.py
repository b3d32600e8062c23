"""The iteration of paper A, Eqs. 21-25, with step control."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.update.data.nominal import Evaluation
from updating.update.data.system import Linear, System
from updating.update.gauss_newton import bounded_step, halved, least_squares_step, strong

CONVERGED = 1e-7
"""Increments under this share of a parameter's doubt end the iteration [-]."""

RESTORED = 2
"""So often is the end of a step brought back to the data before the step is shortened. Doubled: fewer steps, each of
more evaluations."""

GRID = 9
"""Values tried of a parameter that is no factor, to find where to start."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Where the iteration came to rest.

    Parameters
    ----------
    theta : (p,) array
        Coordinates.
    evaluations : tuple of Evaluation
        Specimens there.
    history : (iterations + 1, p) array
        Coordinates of every iteration.
    converged : bool
        Whether the increments died out.
    """

    theta: FloatArray
    evaluations: tuple[Evaluation, ...]
    history: FloatArray
    converged: bool

    @property
    def iterations(self) -> int:
        """Number of steps."""
        return len(self.history) - 1


def solve(
    system: System, start: FloatArray | None = None, *, steps: int = 40, rest: float = CONVERGED
) -> Solution:
    """Iterate from the nominal model until the increments of the parameters vanish.

    Parameters
    ----------
    system : System
        The problem.
    start : (p,) array, optional
        Coordinates to start from; left out, the nominal ones, and for effects the best of a few values.
    steps : int
        Largest number of steps.
    rest : float
        Increments under this share of the doubts end the iteration [-].

    Returns
    -------
    Solution
    """
    theta = _scan(system) if start is None else start
    evaluations = system.evaluations(theta)
    history, converged = [theta], False
    linear, bend = system.linear(theta, evaluations), np.zeros((len(theta), len(theta)))
    for _ in range(steps):
        increment = step(system, linear, theta, bend)
        found = _controlled(system, linear, theta, increment)
        if found is None and bend.any():  # the secant may mislead: once more with Gauss and Newton alone
            bend = np.zeros_like(bend)
            continue
        if found is None:  # no step of any length lowers the misfit
            converged = True
            break
        moved, (theta, evaluations) = found[0] - theta, found
        before, linear = linear, system.linear(theta, evaluations)
        bend = _bent(bend, before, linear, moved, system.doubt)
        history.append(theta)
        converged = bool(np.all(np.abs(moved) <= rest * system.doubt))
        if converged:
            break
    return Solution(theta, evaluations, np.array(history), converged)


def _bent(
    bend: FloatArray, before: Linear, after: Linear, moved: FloatArray, doubt: FloatArray
) -> FloatArray:
    """Return the part of the Hessian that Gauss and Newton leave out, corrected by the last step.

    A symmetric rank-one secant update of the residuals' curvature alone (Dennis, Gay and Welsch 1981), in units
    of the doubts. Where tolerances pull against the data the residuals do not vanish, and without it the
    iteration creeps.
    """
    load = after.weight * after.residual
    change = -((after.sensitivity - before.sensitivity) * doubt).T @ load
    step = moved / doubt
    gap = change - bend @ step
    size = float(gap @ step)
    if abs(size) <= 1e-8 * np.linalg.norm(gap) * np.linalg.norm(step):
        return bend
    return np.asarray(bend + np.outer(gap, gap) / size)


def step(system: System, linear: Linear, theta: FloatArray, bend: FloatArray | None = None) -> FloatArray:
    """Return the increment of Eq. 25: (S'WS + W_theta)^-1 [S'W dlambda - W_theta (theta - theta_0)].

    Solved by singular values, in units of the parameters' doubts; directions that nothing determines stay where
    they are. Parameters at a bound that the step would push further stay there. ``bend`` (p, p) is the curvature
    of the residuals, in units of the doubts, and joins the matrix where that stays positive definite.
    """
    root = np.sqrt(linear.weight)
    rows = np.vstack([root[:, None] * linear.sensitivity, np.diag(np.sqrt(system.prior))])
    load = np.concatenate([root * linear.residual, np.sqrt(system.prior) * (system.centre - theta)])

    def of_free(free: BoolArray) -> FloatArray:
        part = None if bend is None or not bend.any() else bend[np.ix_(free, free)]
        return np.asarray(_least((rows * system.doubt)[:, free], load, part) * system.doubt[free])

    return bounded_step(of_free, theta, system.low, system.high)


def _least(rows: FloatArray, load: FloatArray, bend: FloatArray | None) -> FloatArray:
    if bend is not None and rows.shape[1]:
        normal = rows.T @ rows
        values, vectors = np.linalg.eigh(normal + bend)
        if values.min() > 0.05 * np.linalg.eigvalsh(normal).min() > 0:
            return np.asarray(vectors @ ((vectors.T @ (rows.T @ load)) / values))
    return least_squares_step(rows, load)


def _controlled(
    system: System, linear: Linear, theta: FloatArray, increment: FloatArray
) -> tuple[FloatArray, tuple[Evaluation, ...]] | None:
    """Shorten the step until the misfit does not grow; None where it does not come to that."""
    before = system.cost(theta, linear.evaluations) * (1 + 1e-12)

    def attempt(new: FloatArray) -> tuple[FloatArray, tuple[Evaluation, ...]] | None:
        evaluations = system.evaluations(new)
        for _ in range(RESTORED):
            if system.cost(new, evaluations) <= before:
                return new, evaluations
            new = _restored(system, linear, new, evaluations)
            evaluations = system.evaluations(new)
        return (new, evaluations) if system.cost(new, evaluations) <= before else None

    smallest, bounds = CONVERGED * system.doubt, (system.low, system.high)
    return halved(attempt, theta, increment, bounds, smallest=smallest, most=14)


def _restored(
    system: System, linear: Linear, theta: FloatArray, evaluations: tuple[Evaluation, ...]
) -> FloatArray:
    """Return coordinates brought back to the data in those directions that data determine better than the doubts.

    Sharp data and wide tolerances leave a valley that is narrow and bent. A step along it leaves it by the bend, and
    would have to be short; the second-order correction of sequential quadratic programming (Nocedal and Wright 2006,
    Eq. 18.36) takes the end of a long one back into it, with the sensitivities of its beginning.
    """
    root = np.sqrt(linear.weight)
    left, size, right = np.linalg.svd(
        (root[:, None] * linear.sensitivity) * system.doubt, full_matrices=False
    )
    known = strong(size, 1.0)
    load = left[:, known].T @ (root * system.residual(evaluations))
    back = system.doubt * (right[known].T @ (load / size[known]))
    return np.asarray(np.clip(theta + back, system.low, system.high))


def _scan(system: System) -> FloatArray:
    """Start factors and numbers of a deck as they are, the others, one by one, at the best of a few values."""
    theta = system.start.copy()
    for i, model_parameter in enumerate(system.model_parameters):
        if model_parameter.factor is not None or model_parameter.of_deck is not None:
            continue
        tried = []
        for value in _trials(system, i, float(theta[i])):
            theta[i] = value
            tried.append((system.cost(theta, system.evaluations(theta)), float(value)))
        theta[i] = min(tried)[1]
    return theta


def _trials(system: System, index: int, start: float) -> list[float]:
    """Return values over a parameter's range; with shapes also near the start, for far from it they do not hold."""
    low, high = float(system.low[index]), float(system.high[index])
    values = [*np.linspace(low, high, GRID).tolist(), start]
    if system.shapes:
        near = (high - low) / (GRID - 1) * 0.5 ** np.arange(1, 5)
        values += [v for v in (*(start - near), *(start + near)) if low <= v <= high]
    return values
