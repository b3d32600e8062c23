"""The model's axes in the coordinates of the test."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError


@dataclass(frozen=True)
class Axes:
    """Where the model's origin lies in test coordinates and which way its x and y point.

    Parameters
    ----------
    origin : tuple of 3 floats
        Model origin in test coordinates [m].
    x, y : tuple of 3 floats
        Directions of the model's x and y axes in test coordinates [-]; z completes them right-handed.

    Raises
    ------
    StudyError
        If x and y are not perpendicular.
    """

    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x: tuple[float, float, float] = (1.0, 0.0, 0.0)
    y: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        lengths = math.hypot(*self.x), math.hypot(*self.y)
        if min(lengths) == 0:
            raise StudyError(f"axes: x = {list(self.x)} or y = {list(self.y)} has no direction")
        cosine = sum(a / lengths[0] * (b / lengths[1]) for a, b in zip(self.x, self.y, strict=True))
        if not abs(cosine) <= 1e-3:
            raise StudyError(f"axes: x = {list(self.x)} and y = {list(self.y)} are not perpendicular")

    @property
    def rotation(self) -> FloatArray:
        """Rows are the model's x, y and z in test coordinates, shape (3, 3) [-]."""
        x = np.asarray(self.x, dtype=float) / math.hypot(*self.x)
        y = np.asarray(self.y, dtype=float) / math.hypot(*self.y)
        return np.stack([x, y, np.cross(x, y)])

    def to_model(self, points: FloatArray) -> FloatArray:
        """Take test coordinates (n, 3) to model coordinates (n, 3) [m]."""
        return np.asarray((points - np.asarray(self.origin)) @ self.rotation.T)
