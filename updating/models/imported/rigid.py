"""Motions of a rigid body, known from the places of the rows, and a rounded stiffness that resists none of them.

The digits of a file hold rigid motions by springs of a size that stiff members give them: of ten digits a stiff
offset, 10^5 times as stiff as its neighbours, moves a first frequency by a per cent. What rounding did to the rigid
motions is known, since the forces in them are zero. The least change of the entries that makes these forces zero is
made, each entry in proportion to its size (Kabe, AIAA J. 23 (1985) 1431-1436, who adjusts a stiffness to measured modes
so).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse
from updating.models.imported.rounding import EPS, relative_rounding

HALF = EPS**0.5
"""Directions of a row that are less of its block are not corrected by themselves [-]: half of all digits."""


def free_motions(stiffness: Sparse, motions: FloatArray, relative: float) -> FloatArray:
    """Return the combinations of motions (n, k) that a stiffness resists by no more than its rounding, (n, m).

    The forces K q have to be within rounding row by row: then, and only then, some matrix that rounds to K has none
    (Oettli and Prager, Numer. Math. 6 (1964) 405-409). At a support a row has forces, however long the structure is.

    Parameters
    ----------
    stiffness : (n, n) sparse array
        The stiffness [SI].
    motions : (n, k) array
        Motions of a rigid body; some may be zero or equal to others.
    relative : float
        Relative error of the stiffness's entries [-].
    """
    scale = _scale(stiffness)
    scaled = _scaled(stiffness, scale)
    basis = _basis(motions * scale[:, None])
    _, mixed = np.linalg.eigh(basis.T @ (scaled @ basis))
    basis = basis @ mixed
    size = abs(scaled)
    own = relative_rounding(scaled) * size.sum(axis=1)  # of the unit vectors of the basis
    within = np.abs(scaled @ basis) <= relative * (size @ np.abs(basis)) + own[:, None]
    return np.asarray(basis[:, within.all(axis=0)] / scale[:, None])


def rank(motions: FloatArray, stiffness: Sparse) -> int:
    """Return how many of some motions (n, k) are different [-]."""
    return int(_basis(motions * _scale(stiffness)[:, None]).shape[1])


def without_forces(stiffness: Sparse, motions: FloatArray) -> tuple[Sparse, float]:
    """Return a stiffness that resists none of some motions (n, k), and the relative forces that are left [-].

    Its entries are changed as little as may be.

    The change is E with E_ij = w_ij (l_i q_j + q_i l_j), w the squares of the scaled entries, q the motions and l the
    multipliers of the conditions E Q = K Q. Conjugate gradients find them in steps, each from the forces that are left,
    as long as these grow smaller.
    """
    scale = _scale(stiffness)
    scaled = _scaled(stiffness, scale)
    basis = _basis(motions * scale[:, None])
    correction = _Correction(scaled.tocoo(), basis)
    left, rounding = np.linalg.norm(scaled @ basis), EPS * np.linalg.norm(abs(scaled) @ np.abs(basis))
    while left > rounding:
        better = Sparse(scaled - correction.of(scaled @ basis))
        if not (force := np.linalg.norm(better @ basis)) < left:
            break
        scaled, left = better, force
    return _scaled(scaled, 1 / scale), float(left)


@dataclass(frozen=True, eq=False)
class _Correction:
    """The least change of a matrix by the forces in some motions.

    Parameters
    ----------
    entries : (n, n) sparse array in coordinates
        The matrix; every entry may change in proportion to its size.
    basis : (n, k) array
        The motions, orthonormal.
    """

    entries: Any
    basis: FloatArray

    def of(self, forces: FloatArray) -> Sparse:
        """Return the change E with E Q = forces (n, k), to a hundredth."""
        size = self.basis.size, self.basis.size
        system = LinearOperator(size, matvec=lambda x: (self._change(x) @ self.basis).ravel(), dtype=float)
        alone = LinearOperator(size, matvec=self._alone, dtype=float)
        with np.errstate(all="ignore"):  # what has no forces left divides by them
            return self._change(cg(system, forces.ravel(), rtol=1e-2, M=alone, maxiter=size[0])[0])

    def _change(self, flat: FloatArray) -> Sparse:
        given, basis, (row, column) = flat.reshape(self.basis.shape), self.basis, self.entries.coords
        there = np.einsum("ij,ij->i", given[row], basis[column])
        back = np.einsum("ij,ij->i", basis[row], given[column])
        change = self.entries.data**2 * (there + back)
        return Sparse(sparse.coo_array((change, (row, column)), self.entries.shape).tocsr())

    def _alone(self, flat: FloatArray) -> FloatArray:
        """Solve row by row, as if no other row changed."""
        return np.asarray(np.einsum("nij,nj->ni", self._inverse, flat.reshape(self.basis.shape)).ravel())

    @cached_property
    def _inverse(self) -> FloatArray:
        (row, column), (n, k) = self.entries.coords, self.basis.shape
        blocks, near = np.zeros((n, k, k)), self.basis[column]
        np.add.at(blocks, row, (self.entries.data**2)[:, None, None] * near[:, :, None] * near[:, None, :])
        return np.asarray(np.linalg.pinv(blocks, rcond=HALF, hermitian=True))


def _scale(stiffness: Sparse) -> FloatArray:
    """Return the roots of the diagonal, 1 where it is not positive, (n,)."""
    diagonal = stiffness.diagonal()
    return np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def _scaled(matrix: Sparse, scale: FloatArray) -> Sparse:
    by = sparse.diags_array(1 / scale)
    return Sparse(by @ matrix @ by)


def _basis(motions: FloatArray) -> FloatArray:
    """Return an orthonormal basis of some motions (n, k), those of equal length first."""
    length = np.linalg.norm(motions, axis=0)
    left, size, _ = np.linalg.svd(motions[:, length > 0] / length[length > 0], full_matrices=False)
    return np.asarray(left[:, size > len(motions) * EPS * size.max(initial=0.0)])
