"""Motions of a rigid body, known from the places of the rows, and a rounded stiffness that resists none of them.

The digits of a file hold rigid motions by springs of a size that stiff members give them: of ten digits a stiff
offset, 10^5 times as stiff as its neighbours, moves a first frequency by a per cent. What rounding did to the rigid
motions is known, since the forces in them are zero; the least change of the entries, each in proportion to its size, that makes
them zero is taken back (Kabe, AIAA J. 23 (1985) 1431-1436, who adjusts a stiffness so to measured modes).
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse
from updating.models.imported.rounding import EPS, relative_rounding


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
    sums = Sparse(abs(scaled) * relative + abs(scaled).sign() * relative_rounding(scaled))
    within = np.abs(scaled @ basis) <= sums @ np.abs(basis)
    return np.asarray(basis[:, within.all(axis=0)] / scale[:, None])


def rank(motions: FloatArray, stiffness: Sparse) -> int:
    """Return how many of some motions (n, k) are different [-]."""
    return _basis(motions * _scale(stiffness)[:, None]).shape[1]


def without_forces(stiffness: Sparse, motions: FloatArray) -> Sparse:
    """Return a stiffness that resists none of some motions (n, k), its entries changed as little as may be.

    The change is E with E_ij = w_ij (l_i q_j + q_i l_j), w the squares of the scaled entries, q the motions and l the
    multipliers of the conditions E Q = K Q, which conjugate gradients find.
    """
    scale = _scale(stiffness)
    entries = _scaled(stiffness, scale).tocoo()
    basis, (row, column), weight = _basis(motions * scale[:, None]), entries.coords, entries.data**2
    size = basis.shape

    def change(flat: FloatArray) -> Sparse:
        given = flat.reshape(size)
        products = np.einsum("ij,ij->i", given[row], basis[column]) + np.einsum(
            "ij,ij->i", basis[row], given[column]
        )
        return Sparse(sparse.coo_array((weight * products, (row, column)), entries.shape).tocsr())

    blocks = np.zeros((size[0], size[1], size[1]))
    np.add.at(blocks, row, weight[:, None, None] * basis[column][:, :, None] * basis[column][:, None, :])
    inverse = np.linalg.pinv(blocks, rcond=EPS**0.5, hermitian=True)
    forces = np.asarray(entries.tocsr() @ basis)
    rounding = EPS * float(np.linalg.norm(abs(entries.tocsr()) @ np.abs(basis)))
    flat, left = cg(
        LinearOperator((basis.size,) * 2, matvec=lambda x: (change(x) @ basis).ravel(), dtype=float),
        forces.ravel(),
        rtol=0.0,
        atol=rounding,
        maxiter=basis.size,
        M=LinearOperator(
            (basis.size,) * 2,
            matvec=lambda x: np.einsum("nij,nj->ni", inverse, x.reshape(size)).ravel(),
            dtype=float,
        ),
    )
    if left:
        return stiffness
    return Sparse(stiffness - _scaled(change(flat), 1 / scale))


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
