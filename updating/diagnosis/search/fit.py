"""The most probable parameters of a candidate: damped Gauss-Newton steps in the unit cube of prior quantiles.

A step s solves (N + d diag N) s = g, with the Fisher information N, the slope g and the damping d (Marquardt 1963, SIAM
Journal 11, 431-441). A parameter at an end of its range whose slope leads out of it is held; any other is clipped
there. A gain lessens the damping, a failure on a slope that was taken at the point itself raises it.

A slope costs an evaluation for each parameter. Of many parameters (``FRESH_PARAMETERS``) a step that gains only
corrects the sensitivities (Broyden 1965, Mathematics of Computation 19, 577-593). They are taken anew where a step
fails or seems to rest, so that no search rests on a corrected slope.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.points import Point, evaluate
from updating.diagnosis.search.slope import Slope, curvature, slope_at
from updating.problem.candidate import Candidate
from updating.thresholds import (
    AT_REST,
    FRESH_PARAMETERS,
    HOPELESS_BEHIND,
    LITTLE_GAIN,
    PATIENT_STEPS,
    UNDERSTEPPED,
)


@dataclass(frozen=True, eq=False)
class Peak:
    """A local maximum and the curvature there.

    Parameters
    ----------
    point : Point
        Where it is.
    normal : (k, k) array
        Fisher information of the prior quantiles, the nuisances integrated out [-].
    gradient : (k,) array
        Slope of the log-likelihood, not zero where the prior ends [-].
    """

    point: Point
    normal: FloatArray
    gradient: FloatArray

    @property
    def outward(self) -> FloatArray:
        """The slope at an end of the range, as far as it leads out of it: one that leads in is of no maximum."""
        u, slope = self.point.coordinates, self.gradient
        return np.where(u <= 0, np.minimum(slope, 0.0), np.where(u >= 1, np.maximum(slope, 0.0), 0.0))


def maximise(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    *,
    keep: BoolArray | None = None,
    rounds: int = 20,
    bar: float = -np.inf,
) -> Peak:
    """Maximise to the nearest maximum of the marginal likelihood within the prior's range.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    candidate : Candidate
        Effects.
    start : (k,) array or Point
        Prior quantiles to start from, or a point evaluated there with the same ``keep``.
    keep : (n,) bool array, optional
        Data to use; left out, all.
    rounds : int
        Most steps from one linearisation of the tolerances; 0 takes the slope at the start.
    bar : float
        Log-likelihood that has been reached elsewhere: a maximisation far below that gains little ends.

    Returns
    -------
    Peak
        Of an impossible point with a unit matrix and no slope; of one that ends far below ``bar`` with the slope last
        stepped on, which may be that of an earlier point.
    """
    point, slope = _ascend(problem, candidate, start, keep, rounds, bar)
    if not point.possible:
        return Peak(point, np.eye(len(point.coordinates)), np.zeros(len(point.coordinates)))
    hopeless = slope is not None and bar - point.marginal.log_likelihood >= HOPELESS_BEHIND
    again = False
    # each time the steps are half as long or less, down to the shortest, which counts as fresh
    while slope is None or not (slope.fresh or hopeless):
        slope, again = slope_at(problem, candidate, point, keep, slope, again=again), True
    return Peak(point, slope.normal, slope.gradient)


def highest(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    *,
    keep: BoolArray | None = None,
    rounds: int = 20,
    bar: float = -np.inf,
) -> Point:
    """Return where steps uphill lead, without the curvature there, which costs an evaluation per parameter.

    It is enough to choose between starts: whether tolerances would rest higher from their own middle is left open.
    """
    return _uphill(problem, candidate, start, keep, rounds, bar)[0]


def _ascend(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    keep: BoolArray | None,
    rounds: int,
    bar: float,
) -> tuple[Point, Slope | None]:
    """Return where a maximisation ends and the slope it was last on; None where that is to be taken anew.

    On its way it takes along where tolerances came to rest. Where they rest higher from their own middle, as they may
    where close modes have changed places meanwhile, it goes on from there.
    """
    point, slope = _uphill(problem, candidate, start, keep, rounds, bar)
    if point.about is None or not point.possible:
        return point, slope
    afresh = evaluate(problem, candidate, point.coordinates, keep=keep)
    if afresh.marginal.log_likelihood > point.marginal.log_likelihood + AT_REST:
        return _uphill(problem, candidate, afresh, keep, rounds, bar)
    return point, slope


def _uphill(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    keep: BoolArray | None,
    rounds: int,
    bar: float,
) -> tuple[Point, Slope | None]:
    """Step uphill as long as it gains; see :func:`_ascend`."""
    point = start if isinstance(start, Point) else evaluate(problem, candidate, start, keep=keep)
    damping, stretch = 1e-3, 1.0
    slope: Slope | None = None
    retake = True
    for step_number in range(rounds if point.possible and len(point.coordinates) else 0):
        if retake or slope is None:
            slope, retake = slope_at(problem, candidate, point, keep, slope), False
        fresh = slope.fresh
        gradient = slope.gradient
        free = ~((point.coordinates <= 0) & (gradient < 0) | (point.coordinates >= 1) & (gradient > 0))
        if not free.any():
            break
        step = _step(slope.normal, gradient, free, damping, stretch)
        if not np.isfinite(step).all():
            break
        there = np.clip(point.coordinates + step, 0.0, 1.0)
        about = point.foreseen(slope.columns @ (there - point.coordinates), keep)
        trial = evaluate(problem, candidate, there, keep=keep, about=about)
        gain = trial.marginal.log_likelihood - point.marginal.log_likelihood
        promised = float(step @ gradient - 0.5 * step @ slope.normal @ step)
        stretch = 2 * stretch if gain > UNDERSTEPPED * promised > 0 else 1.0
        if gain > 0:
            # what the noise's change adds to the slope goes roughly with chi-squared; it is not differenced again
            quieter = min(trial.marginal.chi2 / max(point.marginal.chi2, 1e-12), 1.0)
            columns = _secant(slope.columns, point, trial)
            slope = replace(
                slope, columns=columns, noise_gradient=slope.noise_gradient * quieter, fresh=False
            )
            point, damping = trial, damping / 5
        elif fresh:
            damping *= 10
        missing = LITTLE_GAIN * (bar - point.marginal.log_likelihood) if step_number >= PATIENT_STEPS else 0.0
        at_rest = abs(gain) < AT_REST
        if (at_rest and fresh) or abs(gain) < missing or damping > 1e6:
            break
        if not slope.fresh and (gain <= 0 or at_rest or len(point.coordinates) <= FRESH_PARAMETERS):
            retake = True
        elif gain > 0:
            normal, load = curvature(point, slope.columns, keep)
            slope = replace(slope, normal=normal, load=load)
    return point, slope


def _secant(columns: FloatArray, before: Point, now: Point) -> FloatArray:
    """Correct sensitivities by what a step has shown (Broyden 1965)."""
    step = now.coordinates - before.coordinates
    change = before.comparison.residual - now.comparison.residual
    if not np.isfinite(change).all() or not step.any():
        return columns
    return np.asarray(columns + np.outer(change - columns @ step, step) / float(step @ step))


def _step(
    normal: FloatArray, gradient: FloatArray, free: BoolArray, damping: float, stretch: float
) -> FloatArray:
    """Return the damped step (k,) of the ``free`` parameters, ``stretch`` times as long, none farther than 0.3 [-]."""
    step = np.zeros_like(gradient)
    inner = normal[np.ix_(free, free)]
    ridge = np.diag(damping * np.diag(inner) + 1e-6)
    step[free] = np.linalg.solve(inner + ridge, gradient[free])
    return np.asarray(step * min(stretch, 0.3 / max(np.abs(step).max(), 1e-12)))
