"""How far measured frequencies lie off, to screen many places for a change before any of them is searched.

To first order a mass m lowers ln f of a mode by m phi^2 / 2 where it sits, phi mass-normalised, and a spring k raises
it by k phi^2 / 2 lambda. What all modes have in common beyond that is taken for tolerances, more readily than what
each has of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.state import NOMINAL, State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction

COMMON = 2.0
"""How much more readily a change that all modes have in common is taken for tolerances than one of their own [-]."""

SPARE = 3
"""Modes predicted beyond those measured, among which these find their partners."""


@dataclass(frozen=True, eq=False)
class FrequencyGap:
    """How far the measured frequencies lie off those of a state of the model.

    Parameters
    ----------
    off : (n_modes,) array
        ln of measured over predicted [-].
    metric : (n_modes, n_modes) array
        By which misfits are compared: without what is common to all modes [-].
    prediction : Prediction
        The state's modes, in the order of the measured ones.
    """

    off: FloatArray
    metric: FloatArray
    prediction: Prediction

    @property
    def misfit(self) -> float:
        """What is left of it beyond tolerances [-]."""
        return float(self.off @ self.metric @ self.off)

    def sizes(self, changes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return which size of each change of ln f (n, n_modes) fits best, and the misfit it takes away, each (n,)."""
        along = changes @ self.metric @ self.off
        length = np.maximum(np.einsum("ij,jk,ik->i", changes, self.metric, changes), 1e-300)
        return along / length, along**2 / length


def frequency_gap(predictor: Predictor, state: State = NOMINAL) -> FrequencyGap:
    """Return how far the frequencies of a test lie off those of a state of the model."""
    test = predictor.measured
    count = len(test.frequency)
    now = predictor.predict(state, at_least=count + test.below + SPARE)
    paired = now.select(match(test, now, np.arange(count) + test.below))
    return FrequencyGap(np.log(test.frequency / paired.frequency), common_metric(count), paired)


def common_metric(count: int) -> FloatArray:
    """Return by which misfits of modes are compared, (count, count): without what is common to all modes [-]."""
    return np.asarray(np.eye(count) - 1 / (count + 1 / COMMON**2))
