"""Where points really were: what a hit beside its point, or a sensor beside its place, does to modal constants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.likelihood.hit_scatter import HitScatter
from updating.prediction.prediction import Prediction
from updating.thresholds import END_REACH, REGISTRATION_SHARE


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
        bare = (test.hit < 0)[:, None]
        seen, hit = self._as_measured(now, level, measured)
        by_hit = level * now.gain * seen * now.hit_slopes
        by_sensor = level * now.gain * hit * now.seen_slopes
        sensors = [] if bare.all() else [self._by_place(*self._seen, by_sensor)]
        moved = [self._by_place(*doubt, np.where(bare, by_sensor, by_hit)) for doubt in self._hit]
        return [*moved, *sensors, self._together(by_hit + by_sensor)]

    def _as_measured(
        self, now: Prediction, level: FloatArray, measured: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the shapes at sensor and force, (n_frf, n_modes); where FRFs share one of them, as it was measured.

        Near a node the model hardly determines how far a mode moves there, for it is the place that decides, and the
        other ends' errors go with that.
        """
        test = self.setting.measured
        ends = {"seen": now.seen, "hit": now.hit}
        shared = "hit" if test.roving == "seen" else "seen"
        point = getattr(test, shared)
        alike = (point[:, None] == point) & (test.hit >= 0)
        others = level * now.gain * ends[test.roving]
        power = alike @ others**2
        known = (np.sum(alike, axis=1) > 1)[:, None] & (power > 0)
        ends[shared] = np.where(
            known, alike @ (others * measured) / np.where(known, power, 1.0), ends[shared]
        )
        return ends["seen"], ends["hit"]

    def _together(self, along: FloatArray) -> FloatArray:
        """Return a column for where the points as a whole lie along each axis that leaves it in doubt."""
        columns = [
            (loose * along[axis]).reshape(-1, 1) for axis, loose in enumerate(self._loose.tolist()) if loose
        ]
        return np.hstack(columns) if columns else np.zeros((along[0].size, 0))

    @cached_property
    def _loose(self) -> FloatArray:
        """Doubt in where points lie along the model's axes, of beams one, of plates two [m].

        It is 0 where one end is clamped and they keep their distance from the other. Else it is not stated from which
        end they were measured: half of the doubt in the size. A baseline has the same.
        """
        spec, tolerances = self.setting.predictor.spec, self.setting.tolerances.factors
        if self.setting.before is not None or not spec.outlined:
            return np.zeros(1)
        sizes = {"length": spec.length} | ({"width": spec.width} if spec.kind == "plate" else {})
        doubts = np.array(
            [REGISTRATION_SHARE * tolerances.get(name, 0.0) * size for name, size in sizes.items()]
        )
        ends = [len({edge for edge in spec.clamped if edge[0] == axis}) for axis in "xy"[: len(sizes)]]
        return np.where(np.array(ends) == 1, 0.0, doubts)

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
        return [self._doubted(point, marks), (ranks, np.repeat(about[first][:, None], axes, axis=1))]

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

    def _doubted(self, place: IntArray, sigma: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the rank of every FRF's point (n_frf,) among those that occur, and their doubts (n, dim) [m].

        A point at the end of the model was at the end of the specimen, wherever that is.
        """
        test, spec = self.setting.measured, self.setting.predictor.spec
        points, first, rank = np.unique(place, return_index=True, return_inverse=True)
        doubt = np.repeat(sigma[first][:, None], test.points.shape[1], axis=1)
        for axis, loose in enumerate(self._loose[: doubt.shape[1]].tolist()):
            if loose:
                at, size = test.points[points, axis], (spec.length, spec.width)[axis]
                at_end = np.minimum(at, size - at) < END_REACH * size
                doubt[:, axis] = np.where(at_end, np.hypot(doubt[:, axis], 2 * loose), doubt[:, axis])
        return rank, doubt

    @staticmethod
    def _by_place(rank: IntArray, sigma: FloatArray, along: FloatArray) -> FloatArray:
        """Return one column per point and direction of slopes (dim, n_frf, n_modes), each times the doubt there."""
        n_dim, n_frf, n_modes = along.shape
        columns = np.zeros((n_frf, n_modes, len(sigma), n_dim))
        columns[np.arange(n_frf), :, rank] = np.moveaxis(along * sigma[rank].T[:, :, None], 0, -1)
        return columns.reshape(n_frf * n_modes, -1)
