"""Dependence of the frequencies on the level of the hits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.thresholds import DRIFT_SHARE, LEAST_DRIFT


@dataclass(frozen=True, eq=False)
class Levels(Quantity):
    """Relative change of each frequency over the mean force of the hits."""

    @property
    def present(self) -> bool:
        """Whether the test has such data."""
        return self.setting.measured.slope is not None

    def block(self, view: View) -> Block:
        """Return by how much more than predicted frequencies depend on the force, times its mean.

        What no test is free of may be common to all modes, or scatter from mode to mode.
        """
        test, slope = self.setting.measured, view.now.slope
        assert test.slope is not None
        assert test.slope_sigma is not None
        level = test.level or 1.0
        n = len(test.slope)
        known = np.isfinite(test.slope)
        uneven = np.where(known, view.doubt.fidelity * slope * level, 0.0)
        return Block(
            channel="level",
            residual=level * np.where(known, test.slope - slope, 0.0),
            variance=np.where(known, (level * test.slope_sigma) ** 2 + uneven**2 + self._steady**2, 1.0),
            factors=np.zeros((n, len(self.setting.names))),
            named=np.zeros((n, 0)),
            own=np.where(known, self._steady, 0.0)[:, None],
            mode=np.arange(n),
            idealised=uneven**2 if view.doubt.fidelity else None,
            judged=np.where(known, self._steady**2, 0.0),
        )

    @property
    def _steady(self) -> float:
        """Change of frequency over the levels of a test that needs no joint: it is not kept at one temperature [-]."""
        return max(DRIFT_SHARE * self.setting.measured.repeatability, LEAST_DRIFT)
