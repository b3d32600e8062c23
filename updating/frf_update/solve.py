"""The iteration of a stage: Eq. 10 solved by singular values, cut off where they are below the noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.frf_update.evaluation import Evaluation
from updating.frf_update.stage import Stage, whitened
from updating.update.gauss_newton import bounded_step, halved, least_squares_step

BEGIN = 0.5
"""Discrepancy to begin with [-]."""

LARGEST = 1.0
"""Largest step of a parameter, in its doubts [-]."""

DROWNED = 1.0
"""Singular values under this, in doubts per standard deviation, are weaker than the prior knowledge [-]."""

CONVERGED = 1e-6
"""Increments under this share of a parameter's doubt end an iteration [-]."""

ROUGHLY = 1e-2
"""The same while the discrepancy is still being estimated [-]."""

HALFWAY = 0.7
"""A step that brings the misfit under this share of what it was needs no rival [-]."""

OVERLAP = 0.1
"""Discrepancy under which measured and computed peaks overlap [-]."""

SETTLED = 0.02
"""Relative change of the discrepancy under which it is taken as found [-]."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Where a stage came to rest.

    Parameters
    ----------
    theta : (p,) array
        Coordinates.
    at : Evaluation
        The model there.
    discrepancy : float
        Relative discrepancy of the model [-].
    history : (n, p) array
        Coordinates of every iteration, the start included.
    converged : bool
        Whether the increments died out.
    variance : (n_frf, n_lines) array
        Of noise and discrepancy, by which the last increments were weighted [m^2/N^2].
    """

    theta: FloatArray
    at: Evaluation
    discrepancy: float
    history: FloatArray
    converged: bool
    variance: FloatArray


def solve(
    stage: Stage,
    start: FloatArray,
    *,
    begin: float = BEGIN,
    rounds: int = 12,
    variance: FloatArray | None = None,
) -> Solved:
    """Turn the parameters until they rest, and the discrepancy with them.

    Parameters
    ----------
    stage : Stage
        What is to be solved.
    start : (p,) array
        Coordinates to start from.
    begin : float
        Discrepancy to begin with [-].
    rounds : int
        Largest number of discrepancies tried.
    variance : (n_frf, n_lines) array, optional
        Weights to keep; left out, they follow the discrepancy and the model [m^2/N^2].
    """
    theta, size, history = start, begin, [start]
    at = stage.evaluate(theta)
    if variance is not None:
        theta, at, visited, converged = descend(stage, theta, at, size, share=CONVERGED, variance=variance)
        found = stage.discrepancy(at)
        return Solved(theta, at, found, np.array([start, *visited]), converged, variance)
    for _ in range(rounds):
        theta, at, visited, _ = descend(stage, theta, at, size, share=ROUGHLY)
        history += visited
        found = stage.discrepancy(at)
        new = max(found, size / 4)
        if abs(new - size) <= SETTLED * size or (new < 1e-4 and found == 0.0):
            size = found if found == 0.0 else new
            break
        size = new
    variance = stage.variance(at, size)
    theta, at, visited, converged = descend(stage, theta, at, size, share=CONVERGED, variance=variance)
    history += visited
    return Solved(theta, at, size, np.array(history), converged, variance)


def descend(
    stage: Stage,
    theta: FloatArray,
    at: Evaluation,
    size: float,
    *,
    share: float,
    steps: int = 30,
    variance: FloatArray | None = None,
) -> tuple[FloatArray, Evaluation, list[FloatArray], bool]:
    """Iterate under one discrepancy; of Eq. 9 with the measured and with the model's column the better is taken.

    Where the discrepancy is small, and at the last, peaks overlap and the weights stay as they are at the beginning;
    where it is large they follow the model, so that a peak on its way cannot outweigh all else.
    """
    visited: list[FloatArray] = []
    kept = stage.variance(at, size) if variance is None and size < OVERLAP else variance
    for _ in range(steps):
        best = None
        before = stage.misfit(at, stage.variance(at, size) if kept is None else kept)
        for measured in (False, True):
            if measured and best is not None and best[2] < HALFWAY * before:
                break
            slopes = stage.slopes(theta, at, measured=measured)
            rows, load = whitened(stage, slopes, at, stage.variance(at, size) if kept is None else kept)
            tried = _controlled(
                stage, theta, increment(stage, theta, rows, load), size if kept is None else kept, before
            )
            if tried is not None and (best is None or tried[2] < best[2]):
                best = tried
            if not measured and best is not None and _small(stage, best[0] - theta, 0.05):
                break  # near the goal the model's own column is the right one
        if best is None:
            return theta, at, visited, True
        moved = best[0] - theta
        theta, at = best[0], best[1]
        visited.append(theta)
        if _small(stage, moved, share):
            return theta, at, visited, True
    return theta, at, visited, False


def _small(stage: Stage, moved: FloatArray, share: float) -> bool:
    return bool(np.all(np.abs(moved) <= share * stage.doubt))


def increment(stage: Stage, theta: FloatArray, rows: FloatArray, load: FloatArray) -> FloatArray:
    """Return the step of Eq. 10, at most `LARGEST` doubts; what is at a bound and pushed further stays."""

    def of_free(free: BoolArray) -> FloatArray:
        return np.asarray(
            least_squares_step((rows * stage.doubt)[:, free], load, DROWNED) * stage.doubt[free]
        )

    step = bounded_step(of_free, theta, stage.low, stage.high)
    longest = np.abs(step / stage.doubt).max(initial=0.0)
    return np.asarray(step * min(1.0, LARGEST / max(longest, 1e-300)))


def _controlled(
    stage: Stage, theta: FloatArray, step: FloatArray, weights: FloatArray | float, before: float
) -> tuple[FloatArray, Evaluation, float] | None:
    """Shorten a step until the misfit falls; None if it does not."""

    def attempt(new: FloatArray) -> tuple[FloatArray, Evaluation, float] | None:
        at = stage.evaluate(new)
        variance = stage.variance(at, weights) if isinstance(weights, float) else weights
        misfit = stage.misfit(at, variance)
        return (new, at, misfit) if misfit < before else None

    return halved(attempt, theta, step, (stage.low, stage.high), smallest=CONVERGED * stage.doubt, most=8)
