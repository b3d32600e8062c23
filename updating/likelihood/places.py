"""Where points really were: what a hit beside its point, or a sensor beside its place, does to modal constants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.prediction.prediction import Prediction
from updating.test_data.chain import roving
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
        moved = self._by_place(*self._hit, np.where(bare, by_sensor, by_hit))
        return [moved, *sensors, self._together(by_hit + by_sensor)]

    def _as_measured(
        self, now: Prediction, level: FloatArray, measured: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the shapes at sensor and force, (n_frf, n_modes); where FRFs share one of them, as it was measured.

        Near a node the model says little of how far a mode moves there, for it is the place that decides, and the other
        ends' errors go with that.
        """
        test = self.setting.measured
        ends = {"seen": now.seen, "hit": now.hit}
        shared = "hit" if roving(test) == "seen" else "seen"
        point = getattr(test, shared)
        alike = (point[:, None] == point) & (test.hit >= 0)
        others = level * now.gain * ends[roving(test)]
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

        It is 0 where one end is clamped and they keep their distance from the other. Else nobody says from which end
        they were measured: half of the doubt in the size. A baseline has the same.
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
    def _hit(self) -> tuple[IntArray, FloatArray]:
        test = self.setting.measured
        return self._doubted(np.where(test.hit < 0, test.seen, test.hit), self._by_hits)

    @cached_property
    def _seen(self) -> tuple[IntArray, FloatArray]:
        return self._doubted(self.setting.measured.seen, {})

    @cached_property
    def _by_hits(self) -> dict[int, float]:
        """Doubt in where points were hit on the whole, as far as the scatter of the hits tells, by point [m].

        A baseline was hit at the same marks: what is left is the scatter of either test about them.
        """
        test, before, own = self.setting.measured, self.setting.before, self.setting.scatter
        if own is None:
            return {}
        found = {
            point: max(test.position_sigma, float(own.place[test.hit == point].max()))
            for point in np.unique(test.hit).tolist()
        }
        if before is None or before.scatter is None:
            return found
        for row, twin in before.twins.items():
            found[int(test.hit[row])] = float(np.hypot(own.place[row], before.scatter.place[twin]))
        return found

    def _doubted(self, place: IntArray, known: dict[int, float]) -> tuple[IntArray, FloatArray]:
        """Return the rank of every FRF's point (n_frf,) among those that occur, and their doubts (n, dim) [m]."""
        points, rank = np.unique(place, return_inverse=True)
        axes = range(self.setting.measured.points.shape[1])
        sigma = np.array([[self._sigma(int(p), axis, known) for axis in axes] for p in points])
        return rank, sigma.reshape(len(points), len(axes))

    @staticmethod
    def _by_place(rank: IntArray, sigma: FloatArray, along: FloatArray) -> FloatArray:
        """Return one column per point and direction of slopes (dim, n_frf, n_modes), each times the doubt there."""
        n_dim, n_frf, n_modes = along.shape
        columns = np.zeros((n_frf, n_modes, len(sigma), n_dim))
        columns[np.arange(n_frf), :, rank] = np.moveaxis(along * sigma[rank].T[:, :, None], 0, -1)
        return columns.reshape(n_frf * n_modes, -1)

    def _sigma(self, point: int, axis: int, known: dict[int, float]) -> float:
        """Return the doubt in a point's place; one at the end of the model was at the end of the specimen [m]."""
        test, spec = self.setting.measured, self.setting.predictor.spec
        sigma = known.get(point, test.position_sigma)
        if axis >= len(self._loose) or not self._loose[axis]:
            return sigma
        size, at = (spec.length, spec.width)[axis], float(test.points[point, axis])
        at_end = min(at, size - at) < END_REACH * size
        return float(np.hypot(sigma, 2 * self._loose[axis])) if at_end else sigma
