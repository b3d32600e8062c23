"""COMAC: the test points at which measured and predicted shapes agree least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from acquisition.arrays import FloatArray
from identification.mac import comac
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
        missing = np.nan_to_num(1 - comac(shapes.measured, shapes.predicted))
        at = problem.measured.points[shapes.points]
        middle = centres(problem)[:, : at.shape[1]]
        nearest = np.argmin(np.linalg.norm(middle[:, None] - at[None], axis=2), axis=1)
        return np.asarray(missing[nearest])
