"""Modes followed from the nominal model into a changed one, by their shapes all over the structure.

A diagnosis pairs measured modes with those of a model near what was measured, by shapes at the points. A forecast
compares changes, each far from the nominal model, with one another: there a mode has to be known again by more than
that, and whatever all frequencies have in common is no sign of a mode.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import FloatArray, IntArray
from updating.prediction.assignment import FREQUENCY_WEIGHT
from updating.prediction.prediction import Prediction
from updating.problem.specimen import SpecimenProblem


class Tracked(SpecimenProblem):
    """A problem whose data are the nominal model's own."""

    @cached_property
    def _own(self) -> FloatArray:
        return self.predictor.predict(at_least=self.reach).select(self.order).vectors

    def _match(self, prediction: Prediction) -> IntArray:
        """Return which predicted mode each of the nominal model's has become."""
        test = self.measured
        nominal = self._own
        size = min(len(nominal), len(prediction.vectors))
        alike = (nominal[:size].T @ prediction.vectors[:size]) ** 2
        ratio = np.log(test.frequency[:, None] / prediction.frequency[None, :])
        ratio = np.nan_to_num(ratio, nan=3.0, posinf=3.0, neginf=-3.0)
        common = np.median(ratio[np.arange(len(alike)), alike.argmax(axis=1)])
        cost = 1 - np.nan_to_num(alike) + FREQUENCY_WEIGHT * np.minimum(np.abs(ratio - common), 3.0)
        return np.asarray(linear_sum_assignment(cost)[1])
