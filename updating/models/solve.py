"""The modes of a pair of matrices: the lowest of sparse ones, all of small dense ones."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh
from scipy.linalg.lapack import dsygvd
from scipy.sparse import linalg

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse

DENSE = 400
"""Up to so many unknowns the whole spectrum is solved."""


def lowest(k: Sparse, m: Sparse, count: int) -> tuple[FloatArray, FloatArray]:
    """Solve dense where the model is small, by shift and invert where it is not.

    Parameters
    ----------
    k, m : (n, n) sparse arrays
        Stiffness and mass, the mass positive definite [SI].
    count : int
        Number of modes.

    Returns
    -------
    values : (count,) array
        Eigenvalues in rising order [rad^2/s^2].
    vectors : (n, count) array
        Mass-normalised eigenvectors [kg^-1/2].
    """
    n = k.shape[0]
    if n <= DENSE or count > n // 3:
        values, vectors = eigh(k.toarray(), m.toarray(), subset_by_index=(0, count - 1))
        return values, vectors
    shift = -1e-6 * k.diagonal().sum() / m.diagonal().sum()
    start = np.ones(n)
    values, vectors = linalg.eigsh(k.tocsc(), count, m.tocsc(), sigma=shift, which="LM", v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def solve_pencil(k: FloatArray, m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Solve a small dense pair for all modes, by LAPACK without the checks of a general interface.

    Parameters
    ----------
    k, m : (n, n) arrays
        Stiffness and mass [SI].

    Returns
    -------
    values : (n,) array
        Eigenvalues in rising order, nan where the mass is not positive definite [rad^2/s^2].
    vectors : (n, n) array
        Mass-normalised eigenvectors, unit vectors where the mass is not positive definite [kg^-1/2].
    """
    values, vectors, failed = dsygvd(k, m, uplo="L")
    return (np.full(len(k), np.nan), np.eye(len(k))) if failed else (values, vectors)
