"""Natural frequencies: ln f measured minus predicted."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.thresholds import LEAST_FREQUENCY_NOISE


@dataclass(frozen=True, eq=False)
class Frequencies(Quantity):
    """Natural frequencies.

    Parameters
    ----------
    setting : Setting
        Test and model.
    further : (n_modes,) array
        Variance of ln f that is no noise of the test: what stands in the model beforehand and its mesh leave off [-].
    common : (n_modes, k) array
        What the model leaves off in ln f alike in all modes, per standard deviation: by its mesh, its theory [-].
    mesh : float
        How far a mesh that nobody refined leaves each ln f off, at the most; with the share of idealisations [-].
    """

    further: FloatArray
    common: FloatArray
    mesh: float = 0.0

    @property
    def present(self) -> bool:
        """Whether the test has such data: there is no test without."""
        return True

    def block(self, view: View) -> Block:
        """Return ln f beside a state; what mesh, theory and a candidate's idealisation leave off are named doubts."""
        test, now, before = self.setting.measured, view.now, self.setting.before
        variance, by = self._known_errors, now.log_frequency_by
        named, left = self.common, np.full(len(variance), self.mesh**2)
        if before is not None:
            doubt, known = before.frequency(now)
            variance, by = variance + doubt, by - known
            named = np.column_stack([named, before.common(now)])
        if view.doubt.fidelity:
            # an idealisation errs in the size of the whole shift, and again in each mode
            doubtful = view.doubt.fidelity * np.log(now.frequency / view.unidealised(self.setting).frequency)
            left, named = left + doubtful**2, np.column_stack([named, doubtful])
        residual = np.log(test.frequency / now.frequency)
        modes = np.arange(len(residual))
        return Block(
            channel="frequency", residual=residual, variance=variance + left, factors=by, named=named,
            own=np.zeros((len(modes), 0)), mode=modes, idealised=left if left.any() else None,
        )  # fmt: skip

    @cached_property
    def _known_errors(self) -> FloatArray:
        """Variance of ln f that no state changes, (n_modes,) [-]."""
        test = self.setting.measured
        mounting = max(test.repeatability, LEAST_FREQUENCY_NOISE)
        return (test.frequency_sigma / test.frequency) ** 2 + mounting**2 + self.further
