"""Change of the frequencies over a test, in measuring order."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.thresholds import BENT_COURSE, TREND_SHARE, UNREMARKABLE_TREND


@dataclass(frozen=True, eq=False)
class Trends(Quantity):
    """Relative change of each frequency from the first point to the last."""

    @property
    def present(self) -> bool:
        """Whether the test has such data."""
        return self.setting.measured.trend is not None

    def block(self, view: View) -> Block:
        """Return by how much more than the state drifts each frequency has changed.

        What no test is free of is common to all modes, as is what they did together beside a line, and that a drift
        need not follow one.
        """
        return (
            self._beside(view.state.drift, view.doubt.fidelity) if view.state.drift else self._beside_no_drift
        )

    @cached_property
    def _beside_no_drift(self) -> Block:
        return self._beside(0.0, 0.0)

    def _beside(self, rate: float, fidelity: float) -> Block:
        test = self.setting.measured
        assert test.trend is not None
        assert test.trend_sigma is not None
        n = len(test.trend)
        known = np.isfinite(test.trend)
        uneven = np.where(known, fidelity * rate, 0.0)
        always = np.hypot(UNREMARKABLE_TREND, TREND_SHARE * test.repeatability)
        common = np.linalg.norm([always, test.common_trend_sigma, BENT_COURSE * rate])
        return Block(
            channel="trend",
            residual=np.where(known, test.trend - rate, 0.0),
            variance=np.where(known, test.trend_sigma**2 + uneven**2, 1.0),
            factors=np.zeros((n, len(self.setting.names))),
            named=np.zeros((n, 0)),
            own=np.where(known, common, 0.0)[:, None],
            mode=np.arange(n),
            idealised=uneven**2 if fidelity else None,
        )
