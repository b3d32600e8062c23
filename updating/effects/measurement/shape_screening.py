"""A quick look at the shapes: how near they come to the model's under a reading of the points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.state import Role, State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor
from updating.test_data.chain import measurement_chain
from updating.test_data.measured import Measured

PROMISING = 3
"""How many points, or pairs of points, a look at the shapes passes on to be compared."""


DOUBT = 0.02
"""Share of a mode's mean square by which model and test may differ at any point [-]."""


@dataclass(frozen=True, eq=False)
class ShapeScreening:
    """The nominal model's shapes beside a test's, for a shortlist.

    Parameters
    ----------
    test : Measured
        The test.
    shapes : (n_points, n_modes) array
        Its modes in the model, at its points [kg^-1/2].
    weight : (n_frf, n_modes) array
        Inverse variances of the constants [kg^2].
    """

    test: Measured
    shapes: FloatArray
    weight: FloatArray

    def misfit(self, gains: dict[Role, float], exchanged: tuple[tuple[str, int, int], ...] = ()) -> float:
        """Return the weighted misfit of the shapes, each mode scaled to fit [-]."""
        read = measurement_chain(self.test, State(point_gains=gains, exchanged=exchanged))
        return self._left(read.gain[:, None] * read.product(self.shapes, self.shapes), self.weight)

    def without(self, role: str, point: int) -> float:
        """Return the misfit of the shapes without one point [-]."""
        read = measurement_chain(self.test, State())
        stated = self.test.hit if role == "hit" else self.test.seen
        weight = np.where((stated == point)[:, None], 0.0, self.weight)
        return self._left(read.product(self.shapes, self.shapes), weight)

    def _left(self, predicted: FloatArray, weight: FloatArray) -> float:
        data = self.test.constants
        overlap = np.sum(weight * data * predicted, axis=0)
        power = np.maximum(np.sum(weight * predicted**2, axis=0), 1e-300)
        return float(np.sum(weight * data**2) - np.sum(overlap**2 / power))


def screen(predictor: Predictor) -> ShapeScreening:
    """Return the shapes of a predictor's test and model, modes paired."""
    test = predictor.measured
    prediction = predictor.predict(at_least=len(test.frequency) + 3)
    vectors = prediction.vectors[:, match(test, prediction, np.arange(len(test.frequency)))]
    shapes = predictor.nominal_rows["w"][:, : len(vectors)] @ vectors
    weight = 1.0 / (test.constants_sigma**2 + DOUBT * np.mean(test.constants**2, axis=0))
    return ShapeScreening(test, shapes, weight)
