"""What shear and rotary inertia change of a thin plate's model, on its own reduced basis.

The loads that bend a thin plate to w bend one that shears to w + e as well. With m the moments of w, the thick plate
answers e to the residual R = p - m : eps(r), p the work of the loads and r the turning of its sections; what its
compliance exceeds the thin plate's by is dC = R' e. So, on a basis in which the thin plate has the stiffness K, the
thick one has K (K + dC)^-1 K, and shapes follow with frequencies. The inertia of turning sections joins the mass. A
prediction with both costs what one of the thin plate does.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import PLATE_NAMES, Fields, Sparse
from updating.models.reduced import Change, Reduced
from updating.models.spec import Spec
from updating.models.structure import FieldStructure, build_field_structure, clamped_dofs
from updating.models.terms import FieldTerm, plate_terms

MOST = 12
"""Elements along a side on which shear is worked out, at most [-]: it is smooth but for the narrow elements at the
edges, which every mesh of a thick plate has. Doubled: 0.002 % of frequencies that shear lowers by 0.5 %, five times the
cost."""

SHIFT = 1e-4
"""What holds a free plate: a mass on springs, relative to its lowest elastic eigenvalue [-]. Its share of the change
of that mode; doubled, nothing that can be seen."""


POWERS = {"section": 1.0, "E": 1.0, "thickness": 5.0, "length": -2.0, "width": -2.0}
"""How the change of the stiffness grows with the factors [-]: that of waves inside; along free edges it is h^4."""


@dataclass(frozen=True, eq=False)
class Sheared(Reduced):
    """A thin plate's model with what shear and rotary inertia change; it has all else in common with the thin one.

    Parameters
    ----------
    structure, basis, ranks, changes, lifts
        As of :class:`Reduced`.
    thin : Reduced
        The thin plate.
    """

    thin: Reduced = field(kw_only=True)

    @property
    def sampled(self) -> dict[str, FloatArray]:
        """Fields of the basis at the quadrature points, each (n_points, r)."""
        return self.thin.sampled

    @property
    def kept(self) -> dict[Hashable, Any]:
        """What others computed from the structure alone."""
        return self.thin.kept

    @property
    def parts(self) -> tuple[FloatArray, ...]:
        """Matrix of every term and region, each term (n_regions + 1, r, r) [SI]; the last is no region."""
        return self.thin.parts

    @property
    def sums(self) -> tuple[FloatArray, ...]:
        """Matrix of every term over all regions, each (r, r) [SI]."""
        return self.thin.sums

    @property
    def point_masses(self) -> FloatArray:
        """Matrix of the masses stated by the modeller, shape (r, r) [kg in w]."""
        return self.thin.point_masses


def sheared(reduced: Reduced) -> Reduced:
    """Return a thin plate's model with what shear and rotary inertia change.

    Parameters
    ----------
    reduced : Reduced
        The thin plate.
    """
    if "thick plate" not in reduced.kept:
        reduced.kept["thick plate"] = _changes(reduced)
    changes = reduced.kept["thick plate"]
    return Sheared(reduced.structure, reduced.basis, reduced.ranks, changes, reduced.lifts, thin=reduced)


def _changes(reduced: Reduced) -> tuple[Change, ...]:
    structure, basis = reduced.fielded, reduced.basis
    spec = structure.spec
    thick = _thick(spec.with_theory("mindlin"))
    own = structure.fields.components[0].hermite(thick.fields.points, structure.n_dofs, PLATE_NAMES)
    thin = {name: np.asarray(matrix @ basis) for name, matrix in own.items()}
    stiffness = basis.T @ (structure.matrix("stiffness") @ basis)
    first = structure.rigid_modes
    shift = SHIFT * float(stiffness[first, first]) if first else 0.0
    residual = _residual(thick, thin)
    excess = residual.T @ thick.solve(residual, shift)
    softer = _softer(reduced, stiffness, excess, shift)
    turning = [
        Change("mass", _product(t, thin[t.left.replace("r", "w")], thin[t.right.replace("r", "w")]), t.powers)
        for t in thick.terms
        if t.kind == "mass" and t.left != "w"
    ]
    return (Change("stiffness", softer, POWERS), *turning)


def _softer(reduced: Reduced, stiffness: FloatArray, excess: FloatArray, shift: float) -> FloatArray:
    """Return what the excess of the compliance takes off the stiffness, (r, r) [SI].

    Columns of parts of edges stand beside those of the clamped plate alone: beside whole edges they are nearly alike.
    """
    places = np.arange(len(stiffness))
    lifted = np.zeros(len(stiffness), dtype=bool)
    for columns in reduced.lifts.values():
        lifted[columns] = True
    softer = np.zeros_like(stiffness)
    beside = lifted | (places < reduced.ranks[frozenset()])
    for chosen in (beside, ~lifted) if lifted.any() else (~lifted,):
        here = np.ix_(chosen, chosen)
        held = stiffness[here] + excess[here] + shift * np.eye(int(chosen.sum()))
        change = -excess[here] @ np.linalg.solve(held, stiffness[here])
        softer[here] = (change + change.T) / 2
    return softer


def _thick(spec: Spec) -> FieldStructure:
    """Return a thick plate on no more elements than shear needs, or than its regions need."""
    try:
        return build_field_structure(spec.with_elements(*(min(n, MOST) for n in spec.elements)))
    except StudyError:  # a region falls between the points of a mesh so coarse
        return build_field_structure(spec)


def _residual(thick: FieldStructure, thin: Mapping[str, FloatArray]) -> FloatArray:
    """Return the work of a thin plate's loads less that of its moments in turning sections, (n_dofs, r) [SI].

    Parameters
    ----------
    thick : FieldStructure
        A thick plate.
    thin : mapping of str to (n_points, r) array
        Curvatures of the thin plate at its quadrature points.
    """
    structure, fields = thick.spec.with_theory("kirchhoff"), thick.fields
    deflection = Fields(fields.components[:1], 2)
    loads = np.zeros((thick.n_dofs, thin["w"].shape[1]))
    plain = fields.components[0].hermite(fields.points, thick.n_dofs, PLATE_NAMES)
    for term in plate_terms(structure, fields, thick.region_of):
        if term.kind == "stiffness":
            loads += _worked(term, plain, thin)
    loads[clamped_dofs(structure, deflection).get("rotation", np.zeros(0, dtype=int))] = 0.0
    bent = {"rxx": thin["wxx"], "ryy": thin["wyy"], "rt": 2 * thin["wxy"]}
    for term in thick.terms:
        if term.kind == "stiffness" and term.left in bent:
            loads -= _worked(term, fields.sampled, bent)
    return loads


def _worked(term: FieldTerm, fields: Mapping[str, Sparse], thin: Mapping[str, FloatArray]) -> FloatArray:
    """Return the work of one term's moments in some fields, (n_dofs, r) [SI]."""
    there = fields[term.left].T @ (term.coefficient[:, None] * thin[term.right])
    back = fields[term.right].T @ (term.coefficient[:, None] * thin[term.left])
    return np.asarray((there + back) / 2)


def _product(term: FieldTerm, left: FloatArray, right: FloatArray) -> FloatArray:
    return np.asarray(left.T @ (term.coefficient[:, None] * right))
