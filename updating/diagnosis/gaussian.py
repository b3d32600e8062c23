"""Marginal likelihood of a comparison: nuisances integrated out exactly, in the small space they span."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem import Comparison


@dataclass(frozen=True, eq=False)
class Marginal:
    """A Gaussian residual with variance D + J J^T.

    Parameters
    ----------
    log_likelihood : float
        Logarithm of the marginal likelihood [-].
    chi2 : float
        Mahalanobis length of the residual [-].
    shift : (p,) array
        Most probable nuisances [standard deviations].
    count : int
        Number of data.
    """

    log_likelihood: float
    chi2: float
    shift: FloatArray
    count: int


def marginal(comparison: Comparison, keep: BoolArray | None = None) -> Marginal:
    """Integrate the nuisances out of a comparison.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    keep : (n,) bool array, optional
        Data to use; left out, all.
    """
    rows = slice(None) if keep is None else keep
    r, j, d = comparison.residual[rows], comparison.nuisance[rows], comparison.variance[rows]
    weighted = j / d[:, None]
    inner = cho_factor(np.eye(j.shape[1]) + j.T @ weighted)
    load = weighted.T @ r
    shift = cho_solve(inner, load)
    chi2 = float(r @ (r / d) - load @ shift)
    log_det = float(np.sum(np.log(d)) + 2 * np.sum(np.log(np.diag(inner[0]))))
    return Marginal(-0.5 * (chi2 + log_det + len(r) * np.log(2 * np.pi)), chi2, shift, len(r))


def whiten(
    comparison: Comparison, columns: FloatArray, keep: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return normal matrix and load of least squares on ``columns``, the nuisances integrated out.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    columns : (n, k) array
        Change of the prediction per parameter.
    keep : (n,) bool array, optional
        Data to use; left out, all.

    Returns
    -------
    normal : (k, k) array
    load : (k,) array
    """
    rows = slice(None) if keep is None else keep
    j, d, columns = comparison.nuisance[rows], comparison.variance[rows], columns[rows]
    inner = cho_factor(np.eye(j.shape[1]) + (j.T / d) @ j)

    def inverse(x: FloatArray) -> FloatArray:
        scaled = (x.T / d).T
        return np.asarray(scaled - ((j.T / d).T) @ cho_solve(inner, (j.T / d) @ x))

    solved = inverse(columns)
    return columns.T @ solved, solved.T @ comparison.residual[rows]
