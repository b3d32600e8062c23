"""Receptances of a reduced model, line by line or by its modes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from updating.models.damping import Matrices

CHUNK = 128
"""Lines solved at a time."""

PROPORTIONAL = 1e-12
"""Coupling of the undamped modes by the damping under which they are the damped ones, relative [-]."""


def answers(matrices: Matrices, loads: FloatArray, laplace: ComplexArray) -> ComplexArray:
    """Return Z(s)^-1 times loads, shape (n_lines, r, n_loads) [m/N on the basis].

    Where the damping couples the undamped modes, every line is solved; where it does not, the modes of the reduced
    basis are summed, all of them: since the basis holds the static answers to loads at the test points, this sum
    has its static correction in it.

    Parameters
    ----------
    matrices : Matrices
        K, M, C and D of Z(s) = s^2 M + s C + K + i D.
    loads : (r, n_loads) array
        Forces on the basis [-].
    laplace : (n_lines,) complex array
        Where in the Laplace plane, i omega + sigma where a window's decay is in the data [1/s].
    """
    values, vectors = matrices.undamped
    viscous, structural = matrices.in_modes
    forces = vectors.T @ loads
    if _diagonal(viscous) and _diagonal(structural):
        s = laplace[:, None]
        dynamic = s**2 + s * np.diag(viscous) + values + 1j * np.diag(structural)
        return on_each_line(vectors, forces / dynamic[:, :, None])
    static = np.diag(values) + 1j * structural
    found = []
    for first in range(0, len(laplace), CHUNK):
        s = laplace[first : first + CHUNK, None, None]
        found.append(np.linalg.solve(s**2 * np.eye(len(values)) + s * viscous + static, forces[None]))
    return on_each_line(vectors, np.concatenate(found))


def on_each_line(matrix: FloatArray | ComplexArray, states: FloatArray | ComplexArray) -> ComplexArray:
    """Multiply a matrix (m, r) with the states (n_lines, r, k) of every line, in one product of matrices."""
    return np.asarray(np.moveaxis(np.tensordot(matrix.astype(complex), states, axes=(1, 1)), 0, 1))


def _diagonal(matrix: FloatArray) -> bool:
    size = np.sqrt(np.abs(np.diag(matrix)))
    off = np.abs(matrix - np.diag(np.diag(matrix)))
    scale = np.outer(size, size) + PROPORTIONAL * np.abs(matrix).max(initial=0.0)
    return bool(np.all(off <= np.sqrt(PROPORTIONAL) * scale))


def receptance(matrices: Matrices, seen: FloatArray, hit: FloatArray, laplace: ComplexArray) -> ComplexArray:
    """Return the receptance of every pair of points, shape (n_frf, n_lines) [m/N].

    Parameters
    ----------
    matrices : Matrices
        K, M, C and D.
    seen, hit : (n_frf, r) arrays
        Rows of the basis at the response and at the force of each FRF.
    laplace : (n_lines,) complex array
        Where in the Laplace plane [1/s].
    """
    loads, which = np.unique(hit, axis=0, return_inverse=True)
    states = answers(matrices, loads.T, laplace)
    return np.asarray(np.einsum("fr,lrf->fl", seen, states[:, :, which.ravel()], optimize=True))
