"""Slope and curvature of the log-likelihood at a point, by differences short beside the likelihood's own width."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.points import Point
from updating.likelihood.gaussian import marginals, normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import DIFFERENCE_STEP


def sensitivities(problem: DiagnosisProblem, candidate: Candidate, point: Point) -> FloatArray:
    """Return the change of the prediction per prior quantile, by differences, (n, k) [-].

    It is 0 where a structure beside the point is impossible, so that nothing is predicted there.
    """
    columns = _differences(problem, candidate, point, None, _plain_steps(point))[0]
    return _finite(columns)


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
class Slope:
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
    steps : (k,) array
        Lengths of the differences that it was taken by [-].
    fresh : bool
        Whether it was taken at this very point, by steps that are short enough.
    """

    columns: FloatArray
    normal: FloatArray
    load: FloatArray
    noise_gradient: FloatArray
    steps: FloatArray
    fresh: bool

    @property
    def gradient(self) -> FloatArray:
        """The whole slope of the log-likelihood (k,) [-]."""
        return self.load + self.noise_gradient


def slope_at(
    problem: DiagnosisProblem,
    candidate: Candidate,
    point: Point,
    keep: BoolArray | None,
    before: Slope | None = None,
    *,
    again: bool = False,
) -> Slope:
    """Take the slope at a point by differences, their steps a small share of the likelihood's own width.

    Over a longer step the likelihood falls by its curvature, and its slope is the small difference of two large
    numbers: beside a narrow ridge it points down where the way is up. The width is that of the slope ``before``. Where
    the steps prove too long, the sensitivities are good, and the slope is the data's own; it is not ``fresh``. Taken
    ``again`` at the same point, no step grows: of a likelihood that is not smooth each length may give another width.
    """
    sizes = _plain_steps(point) if before is None else _within_width(before.normal)
    if again and before is not None:
        sizes = np.minimum(sizes, before.steps)
    slope = _sloped(problem, candidate, point, keep, sizes)
    if np.any(_within_width(slope.normal) < 0.5 * sizes):
        return replace(slope, noise_gradient=np.zeros_like(slope.load), fresh=False)
    return slope


def _within_width(normal: FloatArray, *, share: float = 0.05, shortest: float = 1e-6) -> FloatArray:
    """Return steps of differences that are short beside the width of each parameter, the others fixed, (k,) [-].

    Twice the ``share`` of the width, and slopes err more beside a ridge. Below the ``shortest`` step round-off of the
    modes is more than what they change by.
    """
    width = 1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return np.clip(share * width, shortest, DIFFERENCE_STEP)


def _sloped(
    problem: DiagnosisProblem,
    candidate: Candidate,
    point: Point,
    keep: BoolArray | None,
    sizes: FloatArray,
) -> Slope:
    columns, rise, steps = _differences(problem, candidate, point, keep, sizes)
    normal, load = curvature(point, columns, keep)
    rise = rise + 0.5 * steps * np.diag(normal)  # a difference is the slope half a step away
    return Slope(columns, normal, load, _finite(rise - load), np.abs(steps), fresh=True)


def curvature(point: Point, columns: FloatArray, keep: BoolArray | None) -> tuple[FloatArray, FloatArray]:
    """Return Fisher information (k, k) and the data's own slope (k,) by sensitivities (n, k), without nuisances."""
    return normal_equations(point.comparison, _finite(columns), point.marginal.scale, keep)


def _finite(values: FloatArray) -> FloatArray:
    """Return the values with 0 where they are not finite, as beside an impossible structure."""
    return np.where(np.isfinite(values), values, 0.0)
