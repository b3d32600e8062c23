"""Modes that a test misses: what they would have shown is left in the constants of a mode that is close.

The one pole that is fitted where two are takes of the other's constants the projection of its term on its own. Over all
frequencies that of terms 1/(i w - p) is 2 b_i / (b_i + b_k - i (w_k - w_i)), where b are the decay rates; its real part
is what enters the constants. Of two modes five half-widths apart that is a seventh.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Nuisances
from updating.prediction.prediction import Prediction
from updating.thresholds import LEAST_TURN


@dataclass(frozen=True, eq=False)
class MissedModes(Nuisances):
    """Nuisances of constants that hold those of a mode that the model has and the test has not, one of each pair."""

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-]."""
        before, lost = self.setting.nominal, self.setting.missed
        (mode, missed), share = self._pairs
        added = (lost.seen * lost.hit)[:, missed]
        # a shape has no sign of its own: a column that leaps would be no smooth function of the state
        sign = np.where(np.sum(now.constants * before.constants, axis=0) < 0, -1.0, 1.0)
        columns = np.zeros((*level.shape, len(share)))
        columns[:, mode, np.arange(len(share))] = share * (sign * level * now.gain)[:, mode] * added
        return columns.reshape(level.size, len(share))

    @cached_property
    def _pairs(self) -> tuple[IntArray, FloatArray]:
        """Return measured and missed modes that overlap, (2, k), and the share of the second in the first, (k,) [-]."""
        before, missed = self.setting.nominal, self.setting.missed
        half_width = np.nan_to_num(self.setting.measured.damping) * before.frequency
        apart = missed.frequency - before.frequency[:, None]
        share = 4 * half_width[:, None] ** 2 / np.maximum(4 * half_width[:, None] ** 2 + apart**2, 1e-300)
        pairs = np.nonzero(share > LEAST_TURN)
        return np.stack(pairs), share[pairs]
