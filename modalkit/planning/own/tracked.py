"""Modes followed from the nominal model into a changed one, by their shapes all over the structure.

A diagnosis pairs measured modes with those of a model near what was measured, by shapes at the points. A forecast
compares changes, each far from the nominal model, with one another: there a mode has to be known again by more than
that, and whatever all frequencies have in common is no sign of a mode.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from acquisition.arrays import IntArray
from identification.pairing import counterparts, unlikeness
from updating.prediction.prediction import Prediction
from updating.problem.specimen import SpecimenProblem


class Tracked(SpecimenProblem):
    """A problem whose data are the nominal model's own."""

    @cached_property
    def _own(self) -> Prediction:
        return self.predictor.predict(at_least=self.reach).select(self.order)

    def _match(self, prediction: Prediction) -> IntArray:
        """Return which predicted mode each of the nominal model's has become."""
        alike = self._own.overlap(prediction)
        ratio = np.log(self.measured.frequency[:, None] / prediction.frequency[None, :])
        ratio = np.nan_to_num(ratio, nan=3.0, posinf=3.0, neginf=-3.0)
        common = np.median(ratio[np.arange(len(alike)), alike.argmax(axis=1)])
        return counterparts(unlikeness(alike, ratio - common))
