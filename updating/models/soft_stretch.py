"""A soft or stiff stretch of a beam, exact within its elements.

Between two nodes a beam that is loaded there alone has a bending moment that is linear, whatever its stiffness: so the
curvature gathers where it is soft. A cubic element has a curvature that is linear instead, and a stretch shorter than
two or three of them is too stiff by per cents to a half. The energy of an element is 1/2 e' F^-1 e: e are the zeroth
and the first moment of its curvature, which its nodes determine, and F is its flexibility, the integral of [1, s]'
[1, s] / EI (Przemieniecki 1968, Theory of Matrix Structural Analysis, section 5.6). What a stretch changes of F is
integrated as finely as the stretch needs, so that the mesh of the model does not matter. Shear strain is the model's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, cast

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.structure import FieldStructure
from updating.models.terms import FieldTerm


class Profile(NamedTuple):
    """How much softer a beam is along a stretch.

    Parameters
    ----------
    points, lengths : (n,) arrays
        Points of a quadrature along x and the length that each stands for [m].
    compliance : (n,) array
        EI0 / EI - 1 there [-].
    """

    points: FloatArray
    lengths: FloatArray
    compliance: FloatArray


def soft_stretch(reduced: Reduced, profile: Profile, factors: Mapping[str, float]) -> FloatArray:
    """Return the change of stiffness that a stretch makes on a basis, (r, r) [SI].

    Parameters
    ----------
    reduced : Reduced
        The nominal model of a beam, on its basis or on all degrees of freedom.
    profile : Profile
        What is softer, and where.
    factors : mapping of str to float
        Factors of the state on top of which it comes [-].
    """
    structure, cells = reduced.fielded, _Cells.of(reduced.fielded, profile)
    fields: Mapping[str, Any] = structure.fields.sampled if reduced.whole else reduced.sampled
    bending = next(term for term in structure.terms if term.kind == "stiffness")
    before, added = cells.flexibility(bending, factors), cells.flexibility(bending, factors, profile)
    moments = cells.moments(fields[bending.left])
    change = np.linalg.inv(before + added) - np.linalg.inv(before)
    found = np.tensordot(moments, change @ moments, axes=((0, 1), (0, 1)))
    return cast(FloatArray, Sparse(found)) if reduced.whole else np.asarray((found + found.T) / 2)


@dataclass(frozen=True, eq=False)
class _Cells:
    """The elements that a stretch touches.

    Parameters
    ----------
    touched : (m,) int array
        Which elements.
    half : (m,) array
        Half of their lengths [m].
    x, lengths : (m, q) arrays
        Their quadrature, from -1 to 1 in each [-], and the length that each point stands for [m].
    at : (n,) int array
        Which of them each point of the profile lies in.
    there : (n,) array
        Where, from -1 to 1 [-].
    count : int
        Quadrature points of the whole beam.
    """

    touched: IntArray
    half: FloatArray
    x: FloatArray
    lengths: FloatArray
    at: IntArray
    there: FloatArray
    count: int

    @classmethod
    def of(cls, structure: FieldStructure, profile: Profile) -> _Cells:
        """Return the elements of a beam that a profile touches."""
        elements, fields = structure.spec.elements[0], structure.fields
        edges = np.linspace(0.0, structure.spec.length, elements + 1)
        inside = np.clip(np.searchsorted(edges, profile.points, side="right") - 1, 0, elements - 1)
        touched, at = np.unique(inside, return_inverse=True)
        middle, half = ((edges[1:] + edges[:-1]) / 2)[touched], (np.diff(edges) / 2)[touched]
        x = fields.points[:, 0].reshape(elements, -1)[touched]
        return cls(
            touched=touched,
            half=half,
            x=(x - middle[:, None]) / half[:, None],
            lengths=fields.weights.reshape(elements, -1)[touched],
            at=at,
            there=(profile.points - middle[at]) / half[at],
            count=len(fields.weights),
        )

    def flexibility(
        self, term: FieldTerm, factors: Mapping[str, float], profile: Profile | None = None
    ) -> FloatArray:
        """Return the flexibility of each element in bending, or what a profile adds to it, (m, 2, 2) [SI]."""
        elements = self.count // self.x.shape[1]
        stiff = term.scale(factors) * term.coefficient.reshape(elements, -1)[self.touched] / self.lengths
        if profile is None:
            powers = self.x[..., None] ** (0, 1)
            return np.asarray(np.einsum("mq,mqa,mqb->mab", self.lengths / stiff, powers, powers))
        near = np.abs(self.x[self.at] - self.there[:, None]).argmin(axis=1)
        more = profile.lengths * profile.compliance / stiff[self.at, near]
        powers = self.there[:, None] ** (0, 1)
        added = np.zeros((len(self.touched), 2, 2))
        np.add.at(added, self.at, more[:, None, None] * powers[:, :, None] * powers[:, None, :])
        return added

    def moments(self, curvature: FloatArray | Sparse) -> FloatArray:
        """Return the integrals over each element of the curvature (n_points, r), and of x times it, (m, 2, r)."""
        points = self.touched[:, None] * self.x.shape[1] + np.arange(self.x.shape[1])
        there = curvature[points.ravel()]
        values = (there.toarray() if isinstance(there, Sparse) else there).reshape(*points.shape, -1)
        return np.asarray(np.swapaxes(self.lengths[..., None] * self.x[..., None] ** (0, 1), 1, 2) @ values)
