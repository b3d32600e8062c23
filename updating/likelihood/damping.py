"""Damping ratios: ln zeta measured minus predicted."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.prediction.prediction import Prediction
from updating.thresholds import (
    COMMON_DAMPING,
    DAMPING_PER_SHIFT,
    DAMPING_REPEATABILITY,
    LEAST_DAMPING,
    UNSTATED_DAMPING_NOISE,
)


@dataclass(frozen=True, eq=False)
class Dampings(Quantity):
    """Damping ratios, of modes whose damping is measured and expected."""

    @cached_property
    def rows(self) -> IntArray:
        """Modes whose damping is measured and expected."""
        test = self.setting.measured
        finite = np.isfinite(test.damping) & (test.damping > 0)
        known = finite if self.setting.predictor.expects_damping else np.zeros_like(finite)
        return np.asarray(np.flatnonzero(known), dtype=np.int64)

    @property
    def present(self) -> bool:
        """Whether the test has such data; without any its block is empty."""
        return True

    @property
    def doubt(self) -> float:
        """Doubt in the expected damping: a baseline that measured it is more accurate than an estimate [-]."""
        stated = self.setting.tolerances.damping
        return stated if self.setting.before is None else min(stated, DAMPING_REPEATABILITY)

    def block(self, view: View) -> Block:
        """Return ln zeta beside a state, the level of the expected damping a named doubt."""
        return self._beside(view) if len(self.rows) else self._nothing

    @cached_property
    def _nothing(self) -> Block:
        """The block of a test without such data."""
        none, empty = np.zeros(0), np.zeros((0, 0))
        factors = np.zeros((0, len(self.setting.names)))
        return Block(
            channel="damping",
            residual=none,
            variance=none,
            factors=factors,
            named=empty,
            own=empty,
            mode=self.rows,
            judged=none,
        )

    def _beside(self, view: View) -> Block:
        rows, test, now = self.rows, self.setting.measured, view.now
        relative = np.nan_to_num(test.damping_sigma[rows] / test.damping[rows], nan=UNSTATED_DAMPING_NOISE)
        expected = np.maximum(now.damping[rows], LEAST_DAMPING)
        tolerance = self._tolerance(now)[rows]
        # ratios go up or down with frequency as the mechanism has it: viscous ones fall, those of stiffness rise
        moved = DAMPING_PER_SHIFT * np.log(now.frequency[rows] / self.setting.nominal.frequency[rows])
        doubt = view.doubt.damping
        variance = relative**2 + tolerance**2 + doubt**2 + moved**2 + self._of_baseline(now)[rows]
        level = np.stack([np.sqrt(COMMON_DAMPING) * tolerance, np.full(len(rows), doubt)], axis=1)[
            :, : 1 + (doubt > 0)
        ]
        return Block(
            channel="damping",
            residual=np.log(test.damping[rows] / expected),
            variance=variance,
            factors=np.zeros((len(rows), len(self.setting.names))),
            named=level,
            own=np.zeros((len(rows), 0)),
            mode=rows,
            judged=self._mounting(now)[rows] ** 2,
        )

    def _of_baseline(self, now: Prediction) -> FloatArray:
        """Return the variance of what a baseline measured of ln zeta, (n_modes,) [-]: nothing without one."""
        before = self.setting.before
        return np.zeros(len(now.frequency)) if before is None else before.damping(now)

    def _tolerance(self, now: Prediction) -> FloatArray:
        """Return the whole doubt in the expected damping of each mode: small where a baseline measured it [-]."""
        mounting = self._mounting(now)
        return np.where(mounting > 0, mounting, self.setting.tolerances.damping)

    def _mounting(self, now: Prediction) -> FloatArray:
        """Return how far damping that a baseline measured scatters from mounting to mounting, at the most, (n_modes,).

        Nothing of modes that it has not [-].
        """
        before = self.setting.before
        if before is None:
            return np.zeros(len(now.frequency))
        return np.where(before.seen(now) > 0.5, self.doubt, 0.0)
