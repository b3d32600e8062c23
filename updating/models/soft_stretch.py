"""A soft or stiff stretch of a beam, exact within its elements.

Between two nodes a beam that is loaded there alone has a bending moment that is linear, whatever its stiffness: so the
curvature gathers where it is soft. A cubic element has a curvature that is linear instead, and a stretch shorter than
two or three of them is too stiff by per cents to a half. The energy of a cell, one element or some, is 1/2 e' F^-1 e:
e are the zeroth and the first moment of its curvature, which its ends determine, and F is its flexibility, the integral
of [1, s]' [1, s] / EI (Przemieniecki 1968, Theory of Matrix Structural Analysis, section 5.6). What a stretch changes
of F is integrated as finely as the stretch needs, so that the mesh of the model does not matter. Shear strain is the
model's.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.structure import FieldStructure


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
    structure = reduced.fielded
    fields: Mapping[str, Any] = structure.fields.sampled if reduced.whole else reduced.sampled
    bending = next(term for term in structure.terms if term.kind == "stiffness")
    cell, there = _placed(structure, profile.points)
    touched, at = np.unique(cell, return_inverse=True)
    points = np.flatnonzero(np.isin(structure.cell_of, touched))
    own, x = np.searchsorted(touched, structure.cell_of[points]), structure.within_cell[points]
    lengths, count = structure.fields.weights[points], len(touched)
    stiff = bending.scale(factors) * bending.coefficient[points] / lengths
    near = np.abs(structure.fields.points[points, 0] - profile.points[:, None]).argmin(axis=1)
    before = _flexibility(lengths / stiff, x, own, count)
    added = _flexibility(profile.lengths * profile.compliance / stiff[near], there, at, count)
    change = np.linalg.inv(before + added) - np.linalg.inv(before)
    moments = _moments(fields[bending.left][points], lengths, x, own, count)
    found = np.tensordot(moments, change @ moments, axes=((0, 1), (0, 1)))
    return cast(FloatArray, Sparse(found)) if reduced.whole else np.asarray((found + found.T) / 2)


def _placed(structure: FieldStructure, points: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the cell in which each place (n,) [m] lies, and where in it, from -1 to 1 [-]."""
    ends = structure.cells
    cell = np.clip(np.searchsorted(ends, points, side="right") - 1, 0, len(ends) - 2)
    return cell, (2 * points - ends[cell] - ends[cell + 1]) / (ends[cell + 1] - ends[cell])


def _flexibility(parts: FloatArray, x: FloatArray, cell: IntArray, count: int) -> FloatArray:
    """Return the flexibility of each cell from the parts (n,) of its points at ``x``, (count, 2, 2) [SI]."""
    powers = x[:, None] ** np.arange(2)
    total = np.zeros((count, 2, 2))
    np.add.at(total, cell, parts[:, None, None] * powers[:, :, None] * powers[:, None, :])
    return total


def _moments(
    curvature: FloatArray | Sparse, lengths: FloatArray, x: FloatArray, cell: IntArray, count: int
) -> FloatArray:
    """Return the integrals over each cell of the curvature (n, r), and of ``x`` times it, (count, 2, r)."""
    values = curvature.toarray() if isinstance(curvature, Sparse) else curvature
    total = np.zeros((count, 2, values.shape[1]))
    for power in range(2):
        np.add.at(total[:, power], cell, (lengths * x**power)[:, None] * values)
    return total
