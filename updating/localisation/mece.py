"""Minimum error in the constitutive relation: where stresses must break the model's law to meet the test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray
from updating.localisation.base import Kind, Localiser
from updating.localisation.force_residual import region_parts
from updating.localisation.shapes import dynamic, shapes_of
from updating.models.absorbers import structural
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class ConstitutiveError(Localiser):
    """Strain energy of u - v, where K v = omega^2 M u and u keeps close to the measured shape.

    The two fields are those for which the energy of their difference, beside the distance from the measured
    components, is least; then the energy of that difference in each region, relative to the energy of the mode,
    measures how far its law is broken.

    Parameters
    ----------
    trust : float
        Weight of the measured components against the energy [-].
    """

    summary: ClassVar[str] = (
        "Strain energy by which the stresses must break the model's law to meet the test."
    )
    needs: ClassVar[str] = "Needs shapes at a few points, and a model whose mass is right."
    misleads: ClassVar[str] = (
        "Misleads where the whole model is off (E, length): that is attributed to regions of high strain "
        "energy, as is noise."
    )
    source: ClassVar[str] = "Ladeveze, Reynier and Nedjar (1994); Deraemaeker, Ladeveze and Leconte (2002)"

    trust: float = 1e2

    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return the error of each region's law, relative to the energy of each mode, over all modes [-]."""
        shapes = shapes_of(problem)
        moved = dynamic(shapes, trust=self.trust)
        force = shapes.stiffness @ moved - shapes.mass @ moved * shapes.omega**2
        held = shapes.stiffness + 1e-6 * float(shapes.omega.min() ** 2) * shapes.mass
        broken = linalg.solve(held, force, assume_a="pos")
        parts = region_parts(problem, "stiffness")
        broken, moved = (structural(one, problem.predictor.base.absorbers) for one in (broken, moved))
        energy = np.einsum("ir,nij,jr->nr", broken, parts, broken)
        stored = np.einsum("ir,ij,jr->r", moved, parts.sum(axis=0), moved)
        share = np.sum(energy / np.maximum(stored, 1e-300), axis=1)
        return np.asarray(np.maximum(share, 0.0))
