"""A candidate at one place of its parameter space: data against prediction, linearised where nuisances bend it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import Marginal, gaussian, marginals
from updating.problem.candidate import Candidate
from updating.thresholds import FARTHEST_TOLERANCE, RELINEARISATIONS, STRAINED_LINEARISATION


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

    def foreseen(self, change: FloatArray, keep: BoolArray | None) -> FloatArray | None:
        """Return about which nuisances to linearise where the prediction is another by ``change`` (n,).

        The most probable ones, as far as this linearisation foresees them; None where this one is about none.
        """
        if self.about is None or not np.isfinite(change).all():
            return self.about
        changed = gaussian(replace(self.comparison, residual=change), (self.marginal.scale,), keep)
        first = np.zeros(1, dtype=np.int64)
        return _within_reach((self.marginal.shift - changed.shift(first, first)[0])[self.comparison.moving])

    @property
    def left_over(self) -> FloatArray:
        """Residual after the most probable nuisances, shape (n,) [-]."""
        return self.comparison.residual - self.comparison.nuisance @ self.marginal.shift


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
    return _within_reach(point.marginal.shift[point.comparison.moving])


def _within_reach(shift: FloatArray) -> FloatArray:
    return np.clip(shift, -FARTHEST_TOLERANCE, FARTHEST_TOLERANCE)


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
