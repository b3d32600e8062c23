"""All model orders from one factorisation of the normal equations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg

from acquisition.arrays import ComplexArray, FloatArray
from identification.poles.stable import stable_roots

_SHORT = 24  # order up to which the eigenvalues of the companion matrix are quicker


def along_diagonals(first: ComplexArray, change: ComplexArray) -> ComplexArray:
    """Return a Hermitian matrix of blocks from its first row and what is added down every diagonal.

    Parameters
    ----------
    first : (m, (n + 1) m) complex array
        First row of blocks.
    change : (n m, n m) complex array
        Blocks [a + 1, b + 1] less blocks [a, b].
    """
    m, width = first.shape
    matrix = np.empty((width, width), complex)
    matrix[:m], matrix[:, :m] = first, first.conj().T
    for a in range(0, width - m, m):
        matrix[a + m : a + 2 * m, m:] = matrix[a : a + m, :-m] + change[a : a + m]
    return np.asarray(0.5 * (matrix + matrix.conj().T))


def denominators(normal: ComplexArray, orders: Sequence[int], n_references: int) -> list[ComplexArray]:
    """Return the denominator coefficients of every order with the constant term fixed to the identity.

    The constant-term constraint throws the mathematical roots outside the unit circle and leaves the
    physical ones inside (Cauberghe, Guillaume, Verboven, Vanlanduit and Parloo, "On the influence of the
    parameter constraint on the stability of the poles", Mech. Syst. Signal Process. 19 (2005) 989-1014). The
    leading blocks of one Cholesky factor solve every order.

    Parameters
    ----------
    normal : ((n + 1) n_references, (n + 1) n_references) complex array
        Reduced normal matrix of the denominator [-].
    orders : sequence of int
        Orders up to n [-].
    n_references : int
        Size of a coefficient [-].

    Returns
    -------
    list of (order, n_references, n_references) complex arrays
        Coefficients A_1 ... A_order [-].
    """
    m = n_references
    inner, right = normal[m:, m:], -normal[m:, :m]
    factor = _cholesky(inner)
    half = linalg.solve_triangular(factor, right, lower=True, check_finite=False)
    found = []
    for order in orders:
        k = order * m
        block = linalg.solve_triangular(factor[:k, :k], half[:k], lower=True, trans="C", check_finite=False)
        found.append(block.reshape(order, m, m))
    return found


def _cholesky(matrix: ComplexArray) -> ComplexArray:
    """Factor a normal matrix that may be singular because the data hold no noise: add what it takes."""
    floor = np.finfo(float).eps * float(np.trace(matrix).real)
    for ridge in (0.0, 1.0, 1e2, 1e4):
        try:
            damped = matrix + ridge * floor * np.eye(len(matrix))
            return np.asarray(linalg.cholesky(damped, lower=True, check_finite=False))
        except linalg.LinAlgError:
            continue
    values, vectors = linalg.eigh(matrix)
    values = np.maximum(values, 1e4 * floor)
    return np.asarray(linalg.cholesky((vectors * values) @ vectors.conj().T, lower=True))


def roots(coefficients: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the stable roots z of I + A_1 z + ... + A_n z^n and their left null vectors.

    Parameters
    ----------
    coefficients : (order, n_references, n_references) complex array
        A_1 ... A_order [-].

    Returns
    -------
    z : (n_roots,) complex array
        Roots inside the unit circle [-].
    participation : (n_roots, n_references) complex array
        Participation vectors of unit length [-].
    """
    order, m, _ = coefficients.shape
    if m > 1:
        inverse, full = linalg.eig(_companion(coefficients), overwrite_a=True, check_finite=False)
        stable = np.abs(inverse) > 1.0
        return _with_unit_vectors(inverse[stable], full[-m:, stable])
    z = stable_roots(np.append(1.0, coefficients)) if order > _SHORT else None
    if z is None:
        inverse = linalg.eigvals(_companion(coefficients), overwrite_a=True, check_finite=False)
        z = np.asarray(1.0 / inverse[np.abs(inverse) > 1.0], complex)
    return z, np.asarray(np.ones((len(z), 1)), complex)


def _companion(coefficients: ComplexArray) -> ComplexArray:
    """Return the matrix whose eigenvalues are the reciprocals of the roots."""
    order, m, _ = coefficients.shape
    companion = np.zeros((order * m, order * m), complex)
    companion[:m] = -coefficients.transpose(2, 0, 1).reshape(m, order * m)
    companion[np.arange(m, order * m), np.arange((order - 1) * m)] = 1.0
    return companion


def _with_unit_vectors(inverse: ComplexArray, vectors: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    length: FloatArray = np.maximum(np.linalg.norm(vectors, axis=0), np.finfo(float).tiny)
    return np.asarray(1.0 / inverse, complex), np.asarray((vectors / length).T, complex)
