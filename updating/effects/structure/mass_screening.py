"""Where more or less mass may sit, to first order: a screening of many places before any of them is searched.

A mass m spread over a place lowers ln f of a mode by half of m times the mean of phi^2 there, phi mass-normalised. What
all modes have in common beyond that is taken for tolerances, more readily than what each has of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.prediction.matching import match
from updating.prediction.predict import Predictor

COMMON = 2.0
"""How much more readily a change that all modes have in common is taken for tolerances than one of their own [-]."""

SPARE = 3
"""Modes predicted beyond those measured, among which these find their partners."""


@dataclass(frozen=True, eq=False)
class FrequencyGap:
    """How far the measured frequencies lie off the nominal ones.

    Parameters
    ----------
    off : (n_modes,) array
        ln of measured over nominal [-].
    metric : (n_modes, n_modes) array
        By which misfits are compared: without what is common to all modes [-].
    vectors : (r, n_modes) array
        Nominal modes on the reduced basis, mass-normalised.
    """

    off: FloatArray
    metric: FloatArray
    vectors: FloatArray

    def sizes(self, falls: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what size of each change (n, n_modes) fits best, and what misfit it takes away, each (n,)."""
        along = falls @ self.metric @ self.off
        length = np.maximum(np.einsum("ij,jk,ik->i", falls, self.metric, falls), 1e-300)
        return along / length, along**2 / length


def frequency_gap(predictor: Predictor) -> FrequencyGap:
    """Return how far the frequencies of a test lie off those of the model as it is."""
    test = predictor.measured
    count = len(test.frequency)
    nominal = predictor.predict(at_least=count + test.below + SPARE)
    chosen = match(test, nominal, np.arange(count) + test.below)
    return FrequencyGap(
        np.log(test.frequency / nominal.frequency[chosen]),
        np.eye(count) - 1 / (count + 1 / COMMON**2),
        nominal.vectors[:, chosen],
    )
