"""Modal force residual: where the model cannot keep the expanded shape in motion at the measured frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray
from updating.localisation.base import Kind, Localiser
from updating.localisation.shapes import dynamic, serep, shapes_of
from updating.models.absorbers import structural
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class ForceResidual(Localiser):
    """Forces (K - omega^2 M) phi that are left over, as the accelerations they cause, summed over each region.

    Parameters
    ----------
    expansion : {"serep", "dynamic"}
        How the shapes are brought to the whole model.
    """

    summary: ClassVar[str] = (
        "Forces left over when the shape, expanded by the model's modes (serep) or by the least force (dynamic), "
        "moves at the measured frequency."
    )
    needs: ClassVar[str] = "Needs shapes at several points in every region."
    misleads: ClassVar[str] = (
        "Misleads with few points: between them the shape is the model's own, and the forces are errors of the "
        "expansion."
    )
    source: ClassVar[str] = (
        "Ojalvo and Pilon (1988), Proc. IMAC 6; Friswell and Mottershead (1995), section 6.4"
    )

    expansion: Literal["serep", "dynamic"] = "serep"

    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return the mean square of the left-over acceleration in each region, relative to the shape's own [-]."""
        shapes = shapes_of(problem)
        whole = serep(shapes) if self.expansion == "serep" else dynamic(shapes)
        force = shapes.stiffness @ whole - shapes.mass @ whole * shapes.omega**2
        acceleration = linalg.solve(shapes.mass, force, assume_a="pos") / shapes.omega**2
        heavy = region_parts(problem, "mass")
        own = structural(acceleration, problem.predictor.base.absorbers)
        left_over = np.einsum("ir,nij,jr->nr", own, heavy, own)
        modal = np.einsum("ir,ij,jr->r", whole, shapes.mass, whole)
        size = np.trace(heavy, axis1=1, axis2=2)
        share = np.sum(left_over / modal, axis=1) / np.maximum(size, 1e-300)
        return np.asarray(np.maximum(share, 0.0))


def region_parts(problem: SpecimenProblem, kind: str) -> FloatArray:
    """Return the stiffness or mass matrix of every region on the reduced basis, (n_regions, r, r) [SI]."""
    predictor = problem.predictor
    reduced, base = predictor.reduced, predictor.base
    n = reduced.ranks[base.released]
    found = np.zeros((len(reduced.parts[0]) - 1, n, n))
    for term, parts in zip(reduced.structure.terms, reduced.parts, strict=True):
        if term.kind == kind:
            found += term.scale(base.factors) * parts[:-1, :n, :n]
    return found
