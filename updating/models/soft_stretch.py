"""A soft or stiff stretch of a beam, exact within its elements.

Between two nodes a beam that is loaded there alone has a bending moment that is linear, whatever its stiffness: so the
curvature gathers where it is soft. A cubic element has a curvature that is linear instead: a stretch of one to three of
them that has lost nine tenths shifts modes by a tenth to two thirds too little. The energy of a cell, one element or
some, is 1/2 e' F^-1 e: e are the zeroth and the first moment of its curvature, which its ends determine, and F is its
flexibility, the integral of [1, s]' [1, s] / EI (Przemieniecki 1968, Theory of Matrix Structural Analysis, section
5.6). What a stretch changes of F is integrated as finely as the stretch needs, so that the mesh of the model does not
matter. Shear strain is the model's.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.reduced import Reduced


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
    """Return the change of stiffness that a stretch makes on a basis, (r, r) [N/m in w].

    It is sparse, over all degrees of freedom, where the model is not reduced.

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
    cell, place_x = structure.in_cells(profile.points)
    touched, place_cell = np.unique(cell, return_inverse=True)
    points = np.flatnonzero(np.isin(structure.cell_of, touched))
    own_cell, own_x = np.searchsorted(touched, structure.cell_of[points]), structure.within_cell[points]
    lengths, count = structure.fields.weights[points], len(touched)
    stiff = bending.scale(factors) * bending.coefficient[points] / lengths
    # a place has the stiffness of the nearest quadrature point
    near = np.abs(structure.fields.points[points, 0] - profile.points[:, None]).argmin(axis=1)
    before = _flexibility(lengths / stiff, own_x, own_cell, count)
    added = _flexibility(profile.lengths * profile.compliance / stiff[near], place_x, place_cell, count)
    change = np.linalg.inv(before + added) - np.linalg.inv(before)
    moments = _moments(fields[bending.left][points], lengths, own_x, own_cell, count)
    found = np.tensordot(moments, change @ moments, axes=((0, 1), (0, 1)))
    return cast(FloatArray, Sparse(found)) if reduced.whole else np.asarray((found + found.T) / 2)


def _flexibility(parts: FloatArray, x: FloatArray, cell: IntArray, count: int) -> FloatArray:
    """Return the flexibility of each cell from its points at ``x`` (n,), (count, 2, 2) [1/(N m)].

    ``parts`` (n,) are the length of each point over E I there [1/(N m)].
    """
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
