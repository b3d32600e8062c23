"""A quick look at the shapes: how near they come to the model's under a reading of the points."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.matching import match
from updating.models.state import Role, State
from updating.prediction import Predictor
from updating.reading import reading

PROMISING = 3
"""How many points, or pairs of points, a look at the shapes passes on to be weighed."""


class ShapeLook:
    """How near the shapes come to the nominal model's under a reading of the points; a quick look for a shortlist."""

    def __init__(self, predictor: Predictor) -> None:
        test = predictor.measured
        self.predictor, self.test = predictor, test
        prediction = predictor.predict(at_least=len(test.frequency) + 3)
        order = match(test, prediction, np.arange(len(test.frequency)))
        self.vectors = prediction.vectors[:, order]
        rows = predictor.nominal_rows["w"][:, : len(self.vectors)]
        self.shapes = rows @ self.vectors
        self.weight = 1.0 / (test.constants_sigma**2 + 0.02 * np.mean(test.constants**2, axis=0))

    def points(self, role: str) -> list[int]:
        """Return the points that appear in a role."""
        return sorted({int(p) for p in (self.test.hit if role == "hit" else self.test.seen) if p >= 0})

    def misfit(self, gains: dict[Role, float], exchanged: tuple[tuple[str, int, int], ...] = ()) -> float:
        """Return the weighted misfit of the shapes, each mode scaled to fit [-]."""
        read = reading(self.test, State(point_gains=gains, exchanged=exchanged))
        return self._left(read.gain[:, None] * read.product(self.shapes, self.shapes), self.weight)

    def without(self, role: str, point: int) -> float:
        """Return the misfit of the shapes without one point [-]."""
        read = reading(self.test, State())
        stated = self.test.hit if role == "hit" else self.test.seen
        weight = np.where((stated == point)[:, None], 0.0, self.weight)
        return self._left(read.product(self.shapes, self.shapes), weight)

    def _left(self, predicted: FloatArray, weight: FloatArray) -> float:
        data = self.test.constants
        overlap = np.sum(weight * data * predicted, axis=0)
        power = np.maximum(np.sum(weight * predicted**2, axis=0), 1e-300)
        return float(np.sum(weight * data**2) - np.sum(overlap**2 / power))
