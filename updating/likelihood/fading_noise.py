"""How the noise fades along the records, beside the window that a state has.

An exponential window that nobody stated adds one decay to all modes, as dampers on all masses do. It also makes the
noise behind the hit fade, which no damper does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block


@dataclass(frozen=True, eq=False)
class FadingNoise(Quantity):
    """The decay of the noise along the records, of tests with hits.

    Parameters
    ----------
    setting : Setting
        Test and model.
    other_reasons : float
        Share of tests whose noise fades, or does not, for a reason of its own [-]: judged. It bounds what the noise may
        say against a state by the factor 1 / ``other_reasons``.
    """

    other_reasons: float = 0.01

    @property
    def present(self) -> bool:
        """Whether the test has such data."""
        return self.setting.measured.fading is not None

    def block(self, view: View) -> Block:
        """Return by how much the noise fades more than the window of a state has it [standard deviations]."""
        return self._beside(view.state.decay) if view.state.decay else self._beside_no_window

    @cached_property
    def _beside_no_window(self) -> Block:
        return self._beside(0.0)

    def _beside(self, decay: float) -> Block:
        fading = self.setting.measured.fading
        assert fading is not None
        off = (fading.log_ratio - fading.expected(decay)) / fading.sigma(decay)
        return Block(
            channel="noise",
            residual=np.array([np.sign(off) * np.sqrt(self._surprise(off))]),
            variance=np.ones(1),
            factors=np.zeros((1, len(self.setting.names))),
            named=np.zeros((1, 0)),
            own=np.zeros((1, 0)),
            mode=np.full(1, -1),
        )

    def _surprise(self, off: float) -> float:
        """Return twice the negative logarithm of the likelihood, over that at no difference [-].

        A residual of which this is the square is as likely as the mixture: noise as expected, or for other reasons.
        """
        usual = (1.0 - self.other_reasons) * np.exp(-0.5 * off**2)
        return float(-2.0 * np.log(usual + self.other_reasons))
