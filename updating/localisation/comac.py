"""COMAC: the test points at which measured and predicted shapes agree least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from acquisition.arrays import FloatArray
from updating.localisation.base import Kind, Localiser
from updating.localisation.places import centres
from updating.localisation.shapes import shapes_of
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class Comac(Localiser):
    """One minus the coordinate modal assurance criterion of the nearest test point."""

    summary: ClassVar[str] = "One minus the correlation of the shapes over the modes at the nearest point."
    needs: ClassVar[str] = "Needs shapes at a point or more in every region."
    misleads: ClassVar[str] = (
        "Misleads where a soft region changes shapes most elsewhere, at a free end for instance, and where a point is "
        "wrong itself; regions that share a point rank alike."
    )
    source: ClassVar[str] = "Lieven and Ewins (1988), Proc. IMAC 6"

    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return 1 - COMAC of the point nearest to each region's centre [-]."""
        shapes = shapes_of(problem)
        products = np.sum(np.abs(shapes.measured * shapes.predicted), axis=1) ** 2
        power = np.sum(shapes.measured**2, axis=1) * np.sum(shapes.predicted**2, axis=1)
        missing = 1 - products / np.maximum(power, 1e-300)
        at = problem.measured.points[shapes.points]
        middle = centres(problem)[:, : at.shape[1]]
        nearest = np.argmin(np.linalg.norm(middle[:, None] - at[None], axis=2), axis=1)
        return np.asarray(np.maximum(missing, 0.0)[nearest])


__all__ = ["Comac"]
