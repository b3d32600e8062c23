"""Natural frequencies: ln f measured minus predicted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.thresholds import LEAST_FREQUENCY_NOISE, MESH_UNEVENNESS


@dataclass(frozen=True, eq=False)
class Frequencies(Quantity):
    """Natural frequencies.

    Parameters
    ----------
    setting : Setting
        Test and model.
    accepted : (n_modes,) array
        Variance of ln f by how far the idealisations of the effects put into the model beforehand may be off [-].
    mesh : (n_modes,) array, optional
        What the mesh leaves off in ln f; None where nothing is known of it, or a baseline has taken it out [-].
    """

    accepted: FloatArray
    mesh: FloatArray | None = None

    @property
    def present(self) -> bool:
        """Whether the test has such data: there is no test without."""
        return True

    def block(self, view: View) -> Block:
        """Return ln f beside a state, the idealisation of a candidate a named doubt."""
        test, now, before = self.setting.measured, view.now, self.setting.before
        variance = (test.frequency_sigma / test.frequency) ** 2 + max(
            test.repeatability, LEAST_FREQUENCY_NOISE
        ) ** 2
        by = now.log_frequency_by
        if before is not None:
            doubt, known = before.frequency(now)
            variance, by = variance + doubt, by - known
        variance = variance + self.accepted
        n = len(test.frequency)
        named = np.zeros((n, 0))
        own, uneven = self._mesh()
        variance = variance + uneven
        if view.doubt.fidelity:
            # an idealisation errs in the size of the whole shift, and again in each mode
            doubtful = view.doubt.fidelity * np.log(now.frequency / self.setting.nominal.frequency)
            variance, named = variance + doubtful**2, doubtful[:, None]
        residual = np.log(test.frequency / now.frequency)
        return Block("frequency", residual, variance, by, named, own, np.arange(n))

    def _mesh(self) -> tuple[FloatArray, FloatArray]:
        """Return what the mesh leaves off in ln f: a column of doubt common to all modes, variance mode by mode."""
        if self.mesh is None:
            n = len(self.setting.measured.frequency)
            return np.zeros((n, 0)), np.zeros(n)
        return self.mesh[:, None], (MESH_UNEVENNESS * self.mesh) ** 2
