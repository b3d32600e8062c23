"""Natural frequencies: ln f measured minus predicted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.thresholds import LEAST_FREQUENCY_NOISE, THEORY_EXPECTED, THEORY_UNEVENNESS


@dataclass(frozen=True, eq=False)
class Frequencies(Quantity):
    """Natural frequencies.

    Parameters
    ----------
    setting : Setting
        Test and model.
    accepted : (n_modes,) array
        Variance of ln f by how far the idealisations of the effects put into the model beforehand may be off [-].
    left_off : tuple of two (n_modes,) arrays, optional
        What the mesh, and what a theory that is no effect, leave off in ln f; None where nothing is known of it, or a
        baseline has taken it out [-].
    """

    accepted: FloatArray
    left_off: tuple[FloatArray, FloatArray] | None = None

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
        expected, own, uneven = self._unmodelled()
        variance = variance + uneven
        if view.doubt.fidelity:
            # an idealisation errs in the size of the whole shift, and again in each mode
            doubtful = view.doubt.fidelity * np.log(now.frequency / self.setting.nominal.frequency)
            variance, named = variance + doubtful**2, doubtful[:, None]
        residual = np.log(test.frequency / now.frequency) - expected
        return Block("frequency", residual, variance, by, named, own, np.arange(n))

    def _unmodelled(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return what mesh and theory leave off in ln f: its expectation, columns of doubt, variance mode by mode.

        The estimate may be half of itself off and a test may come from a thin plate: half of what the theory leaves off
        is expected.
        """
        if self.left_off is None:
            n = len(self.setting.measured.frequency)
            return np.zeros(n), np.zeros((n, 0)), np.zeros(n)
        mesh, theory = self.left_off
        columns = np.stack([mesh, THEORY_EXPECTED * theory], axis=1)
        return (
            THEORY_EXPECTED * theory,
            columns,
            (THEORY_UNEVENNESS * theory) ** 2 + (THEORY_EXPECTED * mesh) ** 2,
        )
