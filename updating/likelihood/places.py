"""Where points really were: what a hit beside its point, or a sensor beside its place, does to modal constants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.likelihood.hit_scatter import HitScatter
from updating.likelihood.registration import registration_doubt, with_registration
from updating.models.state import NOMINAL, Role, State
from updating.prediction.misplaced import beyond_slopes, moved, per_place, squared_wave_numbers
from updating.prediction.prediction import Prediction
from updating.test_data.chain import relabelled


@dataclass(frozen=True, eq=False)
class Marks:
    """Where the hammer was to hit, or where the sensors were to stand.

    Parameters
    ----------
    end : {"hit", "seen"}
        Which of the two.
    first : int
        Which of the columns of :meth:`Places.columns` is the first of theirs; the others follow.
    points : (n,) int array
        Points of the test.
    doubt : (n, d) array
        How well the place of each is known along each axis [m]; then which of several nodes at it is meant [-].
    """

    end: Literal["hit", "seen"]
    first: int
    points: IntArray
    doubt: FloatArray

    @property
    def columns(self) -> IntArray:
        """Their columns, one per point and direction, (n dim,)."""
        return np.arange(self.first, self.first + self.doubt.size)


@dataclass(frozen=True, eq=False)
class Places:
    """Nuisances of the places of hits and sensors: columns of change of the constants per standard deviation.

    Parameters
    ----------
    setting : Setting
        Test and model.
    """

    setting: Setting

    def columns(self, now: Prediction, level: FloatArray, measured: FloatArray) -> list[FloatArray]:
        """Return the change of the constants per standard deviation of what roves, of sensors, of all, (n, k) each [-].

        Parameters
        ----------
        now : Prediction
            The modes.
        level : (n_frf, n_modes) array
            What predicted constants are multiplied by [kg].
        measured : (n_frf, n_modes) array
            The constants that they are to be [-].
        """
        test = self.setting.measured
        by = moved(test, now, level, measured)
        sensors = [] if test.bare else [per_place(*self._seen, by.sensor)]
        first = [per_place(*doubt, by.first) for doubt in self._hit]
        return [*first, *sensors, self._together(by.first + by.sensor)]

    def _together(self, along: FloatArray) -> FloatArray:
        """Return a column for where the points as a whole lie along each axis that leaves it in doubt."""
        columns = [
            (loose * along[axis]).reshape(-1, 1) for axis, loose in enumerate(self._loose.tolist()) if loose
        ]
        return np.hstack(columns) if columns else np.zeros((along[0].size, 0))

    @cached_property
    def _loose(self) -> FloatArray:
        """Doubt in where points lie along the model's axes [m]; a baseline has the same."""
        if self.setting.before is not None:
            return np.zeros(1)
        return registration_doubt(self.setting.predictor.spec, self.setting.tolerances.factors)

    @cached_property
    def _hit(self) -> list[tuple[IntArray, FloatArray]]:
        """Where points were hit: the marks, which all FRFs of a point share, and the hits about them, which may differ.

        FRFs recorded one after the other have hits of their own at one mark; those recorded at once have the same.
        """
        test, own = self.setting.measured, self.setting.scatter
        point = np.where(test.hit < 0, test.seen, test.hit)
        if own is None or test.hit_errors is None:
            return [self._doubted(point, np.full(len(point), test.position_sigma))]
        marks, about = self._marks_and_hits(own)
        hits = test.hit_errors.hits
        pairs = len(np.unique(np.column_stack([point, hits]), axis=0))
        if pairs == len(np.unique(point)) == len(np.unique(hits)):
            return [self._doubted(point, np.hypot(marks, about))]
        ranks, first = np.unique(hits, return_inverse=True)[1], np.unique(hits, return_index=True)[1]
        axes = test.points.shape[1]
        around = np.zeros((len(first), axes + self._sides))
        around[:, :axes] = about[first][:, None]
        return [self._doubted(point, marks), (ranks, around)]

    @property
    def _sides(self) -> int:
        """How many parts of a motion tell several nodes at one place."""
        axes = int(self.setting.measured.points.shape[1])
        return len(self.setting.predictor.doubted) - axes

    def _marks_and_hits(self, own: HitScatter) -> tuple[FloatArray, FloatArray]:
        """Return the doubts in the mark of each FRF and in the mean place of its hits about it, (n_frf,) each [m].

        A baseline was hit at the same marks: what is left is the scatter of either test about them.
        """
        test, before = self.setting.measured, self.setting.before
        marks, about = np.full(len(test.hit), test.position_sigma), own.place.copy()
        if before is not None and before.scatter is not None:
            for row, twin in before.twins.items():
                marks[row], about[row] = 0.0, np.hypot(own.place[row], before.scatter.place[twin])
        return marks, about

    @cached_property
    def _seen(self) -> tuple[IntArray, FloatArray]:
        seen = self.setting.measured.seen
        return self._doubted(seen, np.full(len(seen), self.setting.measured.position_sigma))

    @cached_property
    def marks(self) -> tuple[Marks, ...]:
        """The places at which a prediction may be linearised; none of imported models, and none beside a baseline.

        A baseline had the same marks, and imported models have rows at nodes alone.
        """
        test, spec = self.setting.measured, self.setting.predictor.spec
        stated = test.bare or not np.any(test.hit < 0)
        if not (spec.outlined and stated and len(test.seen)) or self.setting.before is not None:
            return ()
        seen = np.unique(test.seen)
        if test.bare:
            return (Marks("seen", 0, seen, self._hit[0][1]),)
        hits = sum(doubt.size for _, doubt in self._hit)
        return Marks("hit", 0, np.unique(test.hit), self._hit[0][1]), Marks("seen", hits, seen, self._seen[1])

    def left_out(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the variance of what slopes leave out where no prediction is linearised anew, (n_frf, n_modes) [-].

        That of a fixed transducer all constants of a mode share, see :mod:`updating.likelihood.nodes`. A baseline had
        the same points.
        """
        test = self.setting.measured
        if self.marks or self.setting.before is not None or not len(test.seen):
            return np.zeros_like(level)
        doubts = [self._seen] if test.roving == "seen" and not test.bare else self._hit
        bent = np.sum([beyond_slopes(doubt[rank, 0]) for rank, doubt in doubts], axis=0)
        curvature = np.sum(squared_wave_numbers(test, now), axis=0) ** 2 * np.mean(
            (level * now.constants) ** 2, axis=0
        )
        return np.asarray(bent[:, None] * curvature)

    @cached_property
    def movable(self) -> IntArray:
        """Which of the columns of :meth:`columns` are of these marks, (m,)."""
        return np.concatenate([np.zeros(0, dtype=np.int64), *(one.columns for one in self.marks)])

    def elsewhere(self, shift: FloatArray, state: State) -> tuple[State, FloatArray]:
        """Return the state in which the marks lie elsewhere, and by how much, inside of the structure.

        Parameters
        ----------
        shift : (m,) array
            How far they lie from where they are stated, in the order of ``movable`` [standard deviations].
        state : State
            What else is supposed: where labels of points were exchanged, a mark is that of the other point.
        """
        test, spec = self.setting.measured, self.setting.predictor.spec
        away_by: dict[Role, tuple[float, ...]] = {}
        taken = []
        for marks, by in zip(self.marks, self._by_mark(shift), strict=True):
            points = relabelled(marks.points, marks.end, state)
            at = test.points[points]
            size = np.array([spec.length, spec.width][: at.shape[1]])
            there = np.clip(at + by * marks.doubt, np.minimum(at, 0.0), np.maximum(at, size))
            away = there - at
            taken.append((away / np.where(marks.doubt > 0, marks.doubt, 1.0)).ravel())
            away_by |= {
                (marks.end, point): tuple(step)
                for point, step in zip(points.tolist(), away.tolist(), strict=True)
                if any(step)
            }
        return State(moved=away_by) if away_by else NOMINAL, np.concatenate([np.zeros(0), *taken])

    def _by_mark(self, shift: FloatArray) -> list[FloatArray]:
        parts = np.split(shift, np.cumsum([one.doubt.size for one in self.marks])[:-1]) if self.marks else []
        return [part.reshape(one.doubt.shape) for part, one in zip(parts, self.marks, strict=True)]

    def bending(self, now: Prediction, noise: FloatArray) -> FloatArray:
        """Return how far constants leave their linearisation at one standard deviation of each mark, (m,) [noise].

        A shape of wave number k leaves its tangent by half of (k dx)^2 of its size.

        Parameters
        ----------
        now : Prediction
            The modes.
        noise : (n_modes,) array
            Independent noise of the constants of each mode over their r.m.s. [-].
        """
        waves = squared_wave_numbers(self.setting.measured, now)
        worst = np.max(0.5 * waves / noise, axis=1)
        found = [np.zeros(0)]
        for marks in self.marks:  # constants that share a mark leave it together
            sharing = np.count_nonzero(
                getattr(self.setting.measured, marks.end)[:, None] == marks.points, axis=0
            )
            found.append((np.sqrt(sharing)[:, None] * marks.doubt**2 * worst).ravel())
        return np.concatenate(found)

    def _doubted(self, place: IntArray, sigma: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the rank of every FRF's point (n_frf,) among those that occur, and their doubts (n, d).

        A point at the end of the model was at the end of the specimen, wherever that is. Which of several nodes at a
        point is meant is not known; with a baseline it is the same in both tests.
        """
        test, spec = self.setting.measured, self.setting.predictor.spec
        points, first, rank = np.unique(place, return_index=True, return_inverse=True)
        doubt = np.repeat(sigma[first][:, None], test.points.shape[1], axis=1)
        for axis, loose in enumerate(self._loose[: doubt.shape[1]].tolist()):
            if loose:
                at, size = test.points[points, axis], (spec.length, spec.width)[axis]
                doubt[:, axis] = with_registration(doubt[:, axis], at, size, loose)
        unknown = 1.0 if self.setting.before is None else 0.0
        return rank, np.hstack([doubt, np.full((len(doubt), self._sides), unknown)])
