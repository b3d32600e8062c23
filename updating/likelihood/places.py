"""Where points really were: what a hit beside its point, or a sensor beside its place, does to modal constants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
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

    def hits(self, along: FloatArray) -> FloatArray:
        """Return one column per point hit and direction: the effect of having hit beside it.

        Parameters
        ----------
        along : (dim, n_frf, n_modes) array
            Derivatives of the constants by the position of the hit, relative to their scale [1/m].
        """
        return self._by_place(*self._hit, along)

    def sensors(self, along: FloatArray) -> FloatArray:
        """Return one column per sensor and direction: the effect of having mounted it beside its point."""
        if (self.setting.measured.hit < 0).all():
            return np.zeros((along[0].size, 0))
        return self._by_place(*self._seen, along)

    def together(self, hit: FloatArray, seen: FloatArray) -> FloatArray:
        """Return a column for where the points as a whole lie along each axis that leaves it in doubt."""
        bare = (self.setting.measured.hit < 0)[:, None]
        columns = [
            (loose * (np.where(bare, 0.0, hit[axis]) + seen[axis])).reshape(-1, 1)
            for axis, loose in enumerate(self._loose.tolist())
            if loose
        ]
        return np.hstack(columns) if columns else np.zeros((hit[0].size, 0))

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
        return self._doubted(np.where(test.hit < 0, test.seen, test.hit))

    @cached_property
    def _seen(self) -> tuple[IntArray, FloatArray]:
        return self._doubted(self.setting.measured.seen)

    def _doubted(self, place: IntArray) -> tuple[IntArray, FloatArray]:
        """Return the rank of every FRF's point (n_frf,) among those that occur, and their doubts (n, dim) [m]."""
        points, rank = np.unique(place, return_inverse=True)
        axes = range(self.setting.measured.points.shape[1])
        sigma = np.array([[self._sigma(int(p), axis) for axis in axes] for p in points])
        return rank, sigma.reshape(len(points), len(axes))

    @staticmethod
    def _by_place(rank: IntArray, sigma: FloatArray, along: FloatArray) -> FloatArray:
        """Return one column per point and direction of slopes (dim, n_frf, n_modes), each times the doubt there."""
        n_dim, n_frf, n_modes = along.shape
        columns = np.zeros((n_frf, n_modes, len(sigma), n_dim))
        columns[np.arange(n_frf), :, rank] = np.moveaxis(along * sigma[rank].T[:, :, None], 0, -1)
        return columns.reshape(n_frf * n_modes, -1)

    def _sigma(self, point: int, axis: int) -> float:
        """Return the doubt in a point's place; one at the end of the model was at the end of the specimen [m]."""
        test, spec = self.setting.measured, self.setting.predictor.spec
        if axis >= len(self._loose) or not self._loose[axis]:
            return test.position_sigma
        size, at = (spec.length, spec.width)[axis], float(test.points[point, axis])
        at_end = min(at, size - at) < END_REACH * size
        return float(np.hypot(test.position_sigma, 2 * self._loose[axis])) if at_end else test.position_sigma
