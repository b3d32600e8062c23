"""The least-squares factors of a matrix of modal constants, of rank one and symmetric where it overlaps itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray

_TINY = 1e-300
_RIDGE = 1e-14


@dataclass(frozen=True, eq=False)
class Factors:
    """Factors of A ~ long short^T of every mode.

    Parameters
    ----------
    long : (n_rows, n_modes) complex array
        Shape at the rows.
    short : (n_columns, n_modes) complex array
        Shape, or participations, at the columns.
    own : (n_rows, n_modes) array
        Variance each row has for itself.
    common : (n_rows, n_columns, n_modes) complex array
        C of the covariance diag(own) + C C^H of ``long``.
    """

    long: ComplexArray
    short: ComplexArray
    own: FloatArray
    common: ComplexArray


def rank_one(values: ComplexArray, weight: FloatArray) -> Factors:
    """Return factors with the strongest column of ``short`` being 1: shapes up to a factor.

    Alternating weighted least squares.

    Parameters
    ----------
    values : (n_rows, n_columns, n_modes) complex array
        Modal constants; anything where not measured [1/kg].
    weight : (n_rows, n_columns, n_modes) array
        One over their variances; 0 where not measured [kg^2].
    """
    energy = np.sum(weight * np.abs(values) ** 2, axis=0)
    lead, modes = energy.argmax(axis=0), np.arange(values.shape[2])
    short = np.zeros(values.shape[1:], complex)
    short[lead, modes] = 1.0
    for _ in range(0 if values.shape[1] == 1 else 50):
        long = _rows(values, weight, short)
        above = np.maximum(np.einsum("ijm,im->jm", weight, np.abs(long) ** 2), _TINY)
        short = np.einsum("ijm,im->jm", weight * values, long.conj()) / above
        pivot = short[lead, modes]
        short = short / np.where(np.abs(pivot) > 0, pivot, 1.0)
        short[lead, modes] = 1.0
    own = 1.0 / np.maximum(np.einsum("ijm,jm->im", weight, np.abs(short) ** 2), _TINY)
    return Factors(_rows(values, weight, short), short, own, np.zeros(values.shape, complex))


def _rows(values: ComplexArray, weight: FloatArray, short: ComplexArray) -> ComplexArray:
    below = np.maximum(np.einsum("ijm,jm->im", weight, np.abs(short) ** 2), _TINY)
    return np.asarray(np.einsum("ijm,jm->im", weight * values, short.conj()) / below)


def symmetric(
    values: ComplexArray, weight: FloatArray, start: Factors, column: IntArray, *, steps: int
) -> Factors:
    """Return factors in which row and column of one degree of freedom are one unknown: mass-normalised shapes.

    Gauss-Newton on sum |A_ij - phi_i phi_j|^2 / sigma_ij^2. Rows that are no columns are linear in the columns and
    eliminated, so that the equations have the size of the columns. The covariance is that of the normal equations at
    the end: the information of drive points on the scale is weighted by their variances and is in it.

    Parameters
    ----------
    values, weight : (n_rows, n_columns, n_modes) arrays
        As in :func:`rank_one`.
    start : Factors
        Mass-normalised start.
    column : (n_rows,) int array
        Column with the degree of freedom of each row, -1 where there is none.
    steps : int
        Steps; 0 gives the start with its covariance.
    """
    free, tied = np.flatnonzero(column < 0), np.flatnonzero(column >= 0)
    core = column[tied]
    long, short = start.long.copy(), start.short.copy()
    for _ in range(steps):
        slope, inverse, matrix, right = _equations(values, weight, (long, short), (free, tied, core))
        step = np.linalg.solve(matrix, right[:, :, None])[:, :, 0].T
        misfit = values[free] - long[free, None] * short
        along = np.einsum("ijm,ijm,jm->im", weight[free], misfit, short.conj())
        long[free] += inverse * along - np.einsum("ijm,jm->im", slope, step)
        short += step
        long[tied] = short[core]
    slope, inverse, matrix, _ = _equations(values, weight, (long, short), (free, tied, core))
    root = np.linalg.inv(np.linalg.cholesky(matrix)).conj().transpose(2, 1, 0)
    own, common = np.zeros(long.shape), np.zeros(values.shape, complex)
    own[free] = inverse
    common[free] = np.einsum("ijm,jkm->ikm", slope, root)
    common[tied] = -root[core]
    return Factors(long, short, own, common)


def _equations(
    values: ComplexArray,
    weight: FloatArray,
    factors: tuple[ComplexArray, ComplexArray],
    index: tuple[IntArray, IntArray, IntArray],
) -> tuple[ComplexArray, FloatArray, ComplexArray, ComplexArray]:
    """Return -d(free rows)/d(columns), 1 / the free rows' diagonal, and the equations of the columns alone."""
    (long, short), (free, tied, core) = factors, index
    n_columns, n_modes = short.shape
    matrix = np.zeros((n_modes, n_columns, n_columns), complex)
    right = np.zeros((n_modes, n_columns), complex)
    w, row = weight[free], long[free]
    inverse = 1.0 / np.maximum(np.einsum("ijm,jm->im", w, np.abs(short) ** 2), _TINY)
    cross = w * short.conj()[None] * row[:, None]
    misfit = values[free] - row[:, None] * short
    along = np.einsum("ijm,ijm,jm->im", w, misfit, short.conj())
    own = np.einsum("ijm,im->mj", w, np.abs(row) ** 2)
    matrix[:, np.arange(n_columns), np.arange(n_columns)] += own
    matrix -= np.einsum("ijm,im,ikm->mjk", cross.conj(), inverse, cross, optimize=True)
    right += np.einsum("ijm,ijm,im->mj", w, misfit, row.conj())
    right -= np.einsum("ijm,im->mj", cross.conj(), inverse * along)
    for k, i in zip(core, tied, strict=True):
        _add_tied(matrix, right, (values[i], weight[i], short), int(k))
    top = np.einsum("mjj->mj", matrix).real.max(axis=1) + own.max(axis=1)
    matrix += (_RIDGE * top + _TINY)[:, None, None] * np.eye(n_columns)
    return np.asarray(cross * inverse[:, None]), np.asarray(inverse), matrix, right


def _add_tied(
    matrix: ComplexArray, right: ComplexArray, data: tuple[ComplexArray, FloatArray, ComplexArray], k: int
) -> None:
    """Add the equations of the row that is the column k itself: A_kj = phi_k phi_j."""
    values, weight, short = data
    n_columns = len(short)
    jacobian = np.zeros((n_columns, n_columns, short.shape[1]), complex)
    jacobian[:, k] += short
    jacobian[np.arange(n_columns), np.arange(n_columns)] += short[k]
    matrix += np.einsum("jam,jm,jbm->mab", jacobian.conj(), weight, jacobian)
    right += np.einsum("jam,jm,jm->ma", jacobian.conj(), weight, values - short[k] * short)
