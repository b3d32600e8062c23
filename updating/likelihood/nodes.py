"""The level of a mode that hardly moves where all its FRFs meet: what a fixed sensor, or hammer, reads besides.

A transducer feels some of the motion across it, and sits a little askew: an error relative to how the mode moves
elsewhere, not to how it moves there. All constants that share the transducer have it in common. Near a node of a mode
it is a large part of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.prediction.predict import Prediction
from updating.thresholds import LEAST_CONSTANT_NOISE


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nuisances of what fixed transducers read besides, one of each mode and transducer.

    Parameters
    ----------
    setting : Setting
        Test and model.
    """

    setting: Setting

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-].

        Parameters
        ----------
        now : Prediction
            The modes.
        level : (n_frf, n_modes) array
            What predicted constants are multiplied by [kg].
        """
        n_frf, n_modes = now.constants.shape
        columns = np.zeros((n_frf, n_modes, len(self._shared), n_modes))
        if len(self._shared):
            fixed, roving = self._roles
            besides = LEAST_CONSTANT_NOISE * np.sqrt(np.mean(now.at_points**2, axis=0))
            # a shape has no sign of its own: one that leaps would be no smooth function of the state
            sign = np.where(np.sum(now.at_points * self.setting.nominal.at_points, axis=0) < 0, -1.0, 1.0)
            change = now.gain * now.at_points[roving] * besides * sign * level
            for k, place in enumerate(self._shared):
                there = np.flatnonzero(fixed == place)
                columns[there[:, None], np.arange(n_modes), k, np.arange(n_modes)] = change[there]
        return columns.reshape(n_frf * n_modes, -1)

    @cached_property
    def _roles(self) -> tuple[IntArray, IntArray]:
        """Return the point of every FRF that is one of few, and the other, (n_frf,) each."""
        test = self.setting.measured
        few = len(np.unique(test.seen)) <= len(np.unique(test.hit))
        return (test.seen, test.hit) if few else (test.hit, test.seen)

    @cached_property
    def _shared(self) -> IntArray:
        """Points that several FRFs share; none where no level is data."""
        test = self.setting.measured
        if not test.absolute or np.any(test.hit < 0):
            return np.zeros(0, dtype=np.int64)
        points, count = np.unique(self._roles[0], return_counts=True)
        return np.asarray(points[count > 1], dtype=np.int64)
