"""The most probable parameters of a candidate: Gauss-Newton in the unit cube of prior quantiles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import Marginal, marginals, normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import (
    AT_REST,
    DIFFERENCE_SHARE,
    DIFFERENCE_STEP,
    FARTHEST_TOLERANCE,
    FRESH_PARAMETERS,
    HOPELESS_BEHIND,
    LITTLE_GAIN,
    PATIENT_STEPS,
    RELINEARISATIONS,
    SHORTEST_STEP,
    STRAINED_LINEARISATION,
    UNDERSTEPPED,
)


@dataclass(frozen=True, eq=False)
class Point:
    """A candidate at one place of its parameter space.

    Parameters
    ----------
    coordinates : (k,) array
        Prior quantiles [-].
    comparison : Comparison
        Data against prediction there, at the most probable size of the doubt in the idealisation.
    marginal : Marginal
        Its marginal likelihood.
    about : (l,) array, optional
        Nuisances about which the prediction was linearised; None is about none [standard deviations].
    """

    coordinates: FloatArray
    comparison: Comparison
    marginal: Marginal
    about: FloatArray | None = None

    @property
    def possible(self) -> bool:
        """Whether the model has a finite prediction there."""
        return bool(np.isfinite(self.marginal.log_likelihood))

    @property
    def left_over(self) -> FloatArray:
        """Residual after the most probable nuisances, shape (n,) [-]."""
        return self.comparison.residual - self.comparison.nuisance @ self.marginal.shift


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


def evaluate(
    problem: DiagnosisProblem,
    candidate: Candidate,
    coordinates: FloatArray,
    *,
    keep: BoolArray | None = None,
    about: FloatArray | None = None,
) -> Point:
    """Compare a candidate with the data at one place, the first linearisation ``about`` some nuisances."""
    return evaluate_many(problem, candidate, [coordinates], keep=keep, abouts=[about])[0]


def evaluate_many(
    problem: DiagnosisProblem,
    candidate: Candidate,
    places: Sequence[FloatArray] | FloatArray,
    *,
    keep: BoolArray | None = None,
    abouts: Sequence[FloatArray | None] | None = None,
) -> list[Point]:
    """Compare a candidate with the data, re-linearised about the most probable nuisances where these bend it.

    The first linearisation is about the nuisances of a point near by: mostly none is needed after it. Where the
    linearisation swings, the one whose most probable nuisances lie nearest to where it was made stands.

    Parameters
    ----------
    problem, candidate, keep
        As in :func:`maximise`.
    places : sequence of n (k,) arrays
        Prior quantiles [-].
    abouts : sequence of n (l,) arrays or None
        About which nuisances each is linearised first; left out, about none [standard deviations].
    """
    first = [None] * len(places) if abouts is None else abouts
    now = _linearised(problem, candidate, places, first, keep)
    if not problem.wide:
        return now
    best, whole = list(now), [True] * len(now)
    left = [problem.strain(_wanted(point) - _about(point)) for point in now]
    for _ in range(RELINEARISATIONS):
        open_ = [i for i, strain in enumerate(left) if STRAINED_LINEARISATION <= strain < np.inf]
        if not open_:
            break
        moved = [_wanted(now[i]) if whole[i] else 0.5 * (_about(now[i]) + _wanted(now[i])) for i in open_]
        tried = _linearised(problem, candidate, [places[i] for i in open_], moved, keep)
        for i, point, about in zip(open_, tried, moved, strict=True):
            away = problem.strain(_wanted(point) - about)
            now[i], whole[i] = point, away < 0.5 * left[i]
            if away < left[i] and point.possible:
                best[i], left[i] = point, away
    return best


def _about(point: Point) -> FloatArray:
    return np.zeros(len(point.comparison.moving)) if point.about is None else point.about


def _wanted(point: Point) -> FloatArray:
    return np.clip(point.marginal.shift[point.comparison.moving], -FARTHEST_TOLERANCE, FARTHEST_TOLERANCE)


def _linearised(
    problem: DiagnosisProblem,
    candidate: Candidate,
    places: Sequence[FloatArray] | FloatArray,
    abouts: Sequence[FloatArray | None],
    keep: BoolArray | None,
) -> list[Point]:
    comparisons = [problem.at(candidate, *place) for place in zip(places, abouts, strict=True)]
    return [
        Point(place, found.settle(comparison), found, about)
        for place, about, comparison, found in zip(
            places, abouts, comparisons, marginals(comparisons, keep), strict=True
        )
    ]


def sensitivities(problem: DiagnosisProblem, candidate: Candidate, point: Point) -> FloatArray:
    """Return the change of the prediction per prior quantile, by differences, shape (n, k).

    It is 0 where a structure beside the point is impossible, so that nothing is predicted there.
    """
    columns = _differences(problem, candidate, point, None, _plain_steps(point))[0]
    return np.where(np.isfinite(columns), columns, 0.0)


def _plain_steps(point: Point) -> FloatArray:
    return np.full(len(point.coordinates), DIFFERENCE_STEP)


def _differences(
    problem: DiagnosisProblem,
    candidate: Candidate,
    point: Point,
    keep: BoolArray | None,
    sizes: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the change of the prediction (n, k) and of the log-likelihood (k,) per prior quantile, and the steps.

    ``sizes`` (k,) are those of the steps, which go towards the middle.
    """
    steps = np.where(point.coordinates < 0.5, sizes, -sizes)
    there = [problem.at(candidate, moved, point.about) for moved in point.coordinates + np.diag(steps)]
    residuals = np.array([one.residual for one in there]).reshape(len(there), len(point.comparison.residual))
    heights = np.array([one.log_likelihood for one in marginals(there, keep)])
    columns = (point.comparison.residual - residuals).T / steps
    return columns, (heights - point.marginal.log_likelihood) / steps, steps


@dataclass(frozen=True, eq=False)
class _Slope:
    """How the log-likelihood goes on from a point.

    Parameters
    ----------
    columns : (n, k) array
        Sensitivities of the prediction [-].
    normal : (k, k) array
        Fisher information, the nuisances integrated out [-].
    load : (k,) array
        Slope of the log-likelihood, the noise as it is [-].
    noise_gradient : (k,) array
        What the noise's own change with the parameters adds to it [-].
    fresh : bool
        Whether it was taken at this very point, by steps that are short enough.
    """

    columns: FloatArray
    normal: FloatArray
    load: FloatArray
    noise_gradient: FloatArray
    fresh: bool


def _slope(
    problem: DiagnosisProblem,
    candidate: Candidate,
    point: Point,
    keep: BoolArray | None,
    before: _Slope | None = None,
) -> _Slope:
    """Take the slope at a point by differences, their steps a small share of the likelihood's own width.

    Over a longer step the likelihood falls by its curvature, and its slope is the small difference of two large
    numbers: beside a narrow ridge it points down where the way is up. The width is that of the slope ``before``. Where
    the steps prove too long, the sensitivities are good, and the slope is the data's own; it is not ``fresh``.
    """
    sizes = _plain_steps(point) if before is None else _within_width(before.normal)
    slope = _sloped(problem, candidate, point, keep, sizes)
    if np.any(_within_width(slope.normal) < 0.5 * sizes):
        return replace(slope, noise_gradient=np.zeros_like(slope.load), fresh=False)
    return slope


def _within_width(normal: FloatArray) -> FloatArray:
    """Return steps of differences that are short beside the width of each parameter, the others fixed, (k,) [-]."""
    width = 1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return np.clip(DIFFERENCE_SHARE * width, SHORTEST_STEP, DIFFERENCE_STEP)


def _sloped(
    problem: DiagnosisProblem,
    candidate: Candidate,
    point: Point,
    keep: BoolArray | None,
    sizes: FloatArray,
) -> _Slope:
    columns, rise, steps = _differences(problem, candidate, point, keep, sizes)
    normal, load = _curvature(point, columns, keep)
    rise = rise + 0.5 * steps * np.diag(normal)  # a difference is the slope half a step away
    return _Slope(columns, normal, load, _finite(rise - load), fresh=True)


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
        Most steps taken; a maximisation that is at rest ends before.
    bar : float
        Log-likelihood that has been reached elsewhere: a maximisation far below that gains little ends.
    """
    point, slope = _ascend(problem, candidate, start, keep, rounds, bar)
    if not point.possible:
        return Peak(point, np.eye(len(point.coordinates)), np.zeros(len(point.coordinates)))
    hopeless = slope is not None and bar - point.marginal.log_likelihood >= HOPELESS_BEHIND
    while slope is None or not (slope.fresh or hopeless):
        slope = _slope(problem, candidate, point, keep, slope)
    return Peak(point, slope.normal, slope.load + slope.noise_gradient)


def highest(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    *,
    keep: BoolArray | None = None,
    rounds: int = 20,
    bar: float = -np.inf,
) -> Point:
    """Return where :func:`climb` ends, without the curvature there, which costs an evaluation per parameter."""
    return _ascend(problem, candidate, start, keep, rounds, bar)[0]


def _ascend(
    problem: DiagnosisProblem,
    candidate: Candidate,
    start: FloatArray | Point,
    keep: BoolArray | None,
    rounds: int,
    bar: float,
) -> tuple[Point, _Slope | None]:
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
) -> tuple[Point, _Slope | None]:
    """Step uphill as long as it gains; see :func:`_ascend`."""
    point = start if isinstance(start, Point) else evaluate(problem, candidate, start, keep=keep)
    damping, stretch = 1e-3, 1.0
    slope: _Slope | None = None
    retake = True
    for step_number in range(rounds if point.possible and len(point.coordinates) else 0):
        if retake or slope is None:
            slope, retake = _slope(problem, candidate, point, keep, slope), False
        fresh = slope.fresh
        gradient = slope.load + slope.noise_gradient
        free = ~((point.coordinates <= 0) & (gradient < 0) | (point.coordinates >= 1) & (gradient > 0))
        if not free.any():
            break
        step = _step(slope.normal, gradient, free, damping, stretch)
        if not np.isfinite(step).all():
            break
        there = np.clip(point.coordinates + step, 0.0, 1.0)
        trial = evaluate(problem, candidate, there, keep=keep, about=point.about)
        gain = trial.marginal.log_likelihood - point.marginal.log_likelihood
        promised = float(step @ gradient - 0.5 * step @ slope.normal @ step)
        stretch = 2 * stretch if gain > UNDERSTEPPED * promised > 0 else 1.0
        if gain > 0:
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
            normal, load = _curvature(point, slope.columns, keep)
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
    step = np.zeros_like(gradient)
    inner = normal[np.ix_(free, free)]
    ridge = np.diag(damping * np.diag(inner) + 1e-6)
    step[free] = np.linalg.solve(inner + ridge, gradient[free])
    return np.asarray(step * min(stretch, 0.3 / max(np.abs(step).max(), 1e-12)))


def _curvature(point: Point, columns: FloatArray, keep: BoolArray | None) -> tuple[FloatArray, FloatArray]:
    return normal_equations(point.comparison, _finite(columns), point.marginal.scale, keep)


def _finite(values: FloatArray) -> FloatArray:
    """Put nothing in the place of what a prediction beyond all measure leaves."""
    return np.where(np.isfinite(values), values, 0.0)
