"""Lowest modes of sparse stiffness and mass, with or without the dense mass of a fluid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg

from acquisition.arrays import FloatArray

Sparse = scipy.sparse.csr_array
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_ROUNDS = 2


def lowest_modes(
    stiffness: Sparse,
    mass: Sparse,
    *,
    count: int,
    shift: float,
    added: Callable[[FloatArray], FloatArray] | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest undamped modes.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse arrays
        Symmetric; the mass positive definite.
    count : int
        How many [-].
    shift : float
        Stiffness is factorised with so much mass added; positive and small beside the lowest elastic
        eigenvalue [rad^2/s^2].
    added : callable, optional
        Multiplies the dense mass of a fluid with columns.

    Returns
    -------
    omega : (count,) array
        Angular frequencies [rad/s].
    shapes : (n, count) array
        Mass-normalised.

    Notes
    -----
    Dry modes by Lanczos' method about the shift. The fluid's mass couples them; what they lack is added
    by solving for their residuals, in blocks (Davidson's method; Saad, Numerical Methods for Large Eigenvalue
    Problems, 2nd ed., section 8.4).
    """
    factor = scipy.sparse.linalg.splu(
        (stiffness + shift * mass).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )  # fmt: skip
    size = stiffness.shape[0]
    inverse = scipy.sparse.linalg.LinearOperator((size, size), matvec=factor.solve, dtype=float)
    wanted = count if added is None else count + 12
    start = np.cos(2 * np.pi * _GOLDEN * np.arange(1, size + 1))
    values, vectors = scipy.sparse.linalg.eigsh(
        stiffness, wanted, mass, sigma=-shift, OPinv=inverse, v0=start, ncv=2 * wanted + 10
    )
    order = np.argsort(values)
    values, vectors = values[order], vectors[:, order]
    if added is not None:
        values, vectors = _loaded(stiffness, mass, factor.solve, added, vectors, count)
    return np.sqrt(np.maximum(values[:count], 0.0)), vectors[:, :count]


def _loaded(
    stiffness: Sparse,
    mass: Sparse,
    solve: Callable[[FloatArray], FloatArray],
    added: Callable[[FloatArray], FloatArray],
    vectors: FloatArray,
    count: int,
) -> tuple[FloatArray, FloatArray]:
    """Return eigenvalues and vectors with the fluid, from those without it."""

    def moved(columns: FloatArray) -> FloatArray:
        return np.asarray(mass @ columns + added(columns))

    basis, inertia, force = vectors, moved(vectors), stiffness @ vectors
    for left in range(_ROUNDS, -1, -1):
        values, mixed = scipy.linalg.eigh(_even(basis.T @ force), _even(basis.T @ inertia))
        if not left:
            break
        lowest = mixed[:, :count]
        extra = _independent(basis, solve(force @ lowest - (inertia @ lowest) * values[:count]))
        basis = np.hstack([basis, extra])
        inertia, force = np.hstack([inertia, moved(extra)]), np.hstack([force, stiffness @ extra])
    return values, basis @ mixed


def _independent(basis: FloatArray, more: FloatArray) -> FloatArray:
    """Return the part of some columns that a basis lacks, orthonormal."""
    known, _ = np.linalg.qr(basis / np.linalg.norm(basis, axis=0))
    rest = more
    for _ in range(2):
        rest = rest - known @ (known.T @ rest)
    size = np.linalg.norm(rest, axis=0)
    keep = size > 1e-9 * np.linalg.norm(more, axis=0)
    extra, triangle = np.linalg.qr(rest[:, keep] / size[keep])
    return np.asarray(extra[:, np.abs(np.diag(triangle)) > 1e-8])


def _even(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)
