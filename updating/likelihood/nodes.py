"""The level of a mode that hardly moves where all its FRFs meet: what a fixed sensor, or hammer, reads besides.

A transducer feels some of the motion across it, and sits a little askew: an error relative to how the mode moves
elsewhere, not to how it moves there. All constants that share the transducer have it in common. Near a node of a mode
it is a large part of them. The error of a mode's pole stretches its constants alike, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Nuisances
from updating.likelihood.hit_scatter import level_errors
from updating.prediction.prediction import Prediction
from updating.thresholds import LEAST_CONSTANT_NOISE


@dataclass(frozen=True, eq=False)
class Nodes(Nuisances):
    """Nuisances of what fixed transducers read besides, one of each mode and transducer."""

    @property
    def present(self) -> bool:
        """Whether several constants share a transducer."""
        return len(self._shared) > 0

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-]."""
        n_frf, n_modes = now.constants.shape
        columns = np.zeros((n_frf, n_modes, len(self._shared), n_modes))
        if self.present:
            moved, before = self._elsewhere(now), self._elsewhere(self.setting.nominal)
            errors = np.hypot(LEAST_CONSTANT_NOISE, self._stretched(now))
            besides = errors * np.sqrt(np.mean(moved**2, axis=0))
            # a shape has no sign of its own: one that leaps would be no smooth function of the state
            sign = np.where(np.sum(moved * before, axis=0) < 0, -1.0, 1.0)
            change = now.gain * moved * besides * sign * level
            rows, places = self._members
            own = np.arange(n_modes)
            columns[rows[:, None], own, places[:, None], own] = change[rows]
        return columns.reshape(n_frf * n_modes, -1)

    def _stretched(self, now: Prediction) -> FloatArray:
        """Return by how much errors of the poles stretch the constants of each mode, (n_modes,) [-]."""
        setting = self.setting
        own = self._own_errors
        return own if setting.before is None else np.hypot(own, setting.before.level_errors(now))

    @cached_property
    def _own_errors(self) -> FloatArray:
        """How far errors of the test's own poles stretch the constants of each mode, (n_modes,) [-]."""
        return level_errors(self.setting.measured, self.setting.scatter)

    @cached_property
    def _members(self) -> tuple[IntArray, IntArray]:
        """FRFs that share a transducer, and the rank of its point among the shared ones, (n,) each."""
        places, rows = np.nonzero(self._shared[:, None] == self._fixed)
        return rows, places

    @cached_property
    def _fixed(self) -> IntArray:
        """Point of the transducer of every FRF that several share, (n_frf,)."""
        test = self.setting.measured
        return np.asarray(getattr(test, test.fixed))

    def _elsewhere(self, now: Prediction) -> FloatArray:
        """Return the shapes where the other one was, (n_frf, n_modes) [kg^-1/2]."""
        return now.seen if self.setting.measured.roving == "seen" else now.hit

    @cached_property
    def _shared(self) -> IntArray:
        """Points that several FRFs share; none where no level is data."""
        test = self.setting.measured
        if not test.absolute or np.any(test.hit < 0):
            return np.zeros(0, dtype=np.int64)
        points, count = np.unique(self._fixed, return_counts=True)
        return np.asarray(points[count > 1], dtype=np.int64)
