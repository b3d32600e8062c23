"""Nuisances integrated out of many small Gaussians in one batch of Cholesky factors.

The last pivot of the Cholesky factor of a precision bordered by what the residual pulls is chi-squared (Golub and Van
Loan 2013, Matrix Computations, section 4.2), the others' product the determinant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acquisition.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Bordered:
    """Precisions of nuisances, bordered, with what their factors show.

    Parameters
    ----------
    precision : (..., c + 1, c + 1) array
        Of the nuisances, their prior included; in the last row and column what the residual pulls [-].
    chi2 : (...) array
        What is left of the residual's square [-].
    log_det : (...) array
        Logarithm of the determinant of the precision [-].
    """

    precision: FloatArray
    chi2: FloatArray
    log_det: FloatArray

    def shift(self, where: tuple[NDArray[np.integer], ...]) -> FloatArray:
        """Return the most probable nuisances (..., c) of those at some indices [standard deviations]."""
        precision = self.precision[where]
        return np.asarray(np.linalg.solve(precision[..., :-1, :-1], precision[..., :-1, -1:])[..., 0])


def bordered(gram: FloatArray) -> Bordered:
    """Integrate nuisances with a standard normal prior out.

    Parameters
    ----------
    gram : (..., c + 1, c + 1) array
        Squares and products of their columns, the residual the last, over the noise [-]. It is overwritten.
    """
    count = gram.shape[-1] - 1
    # what is added to the residual's corner, more than its round-off, goes from chi-squared again
    corner = 1.0 + 1e-12 * gram[..., -1, -1]
    own = np.arange(count)
    gram[..., own, own] += 1.0
    gram[..., -1, -1] += corner
    pivots = np.diagonal(np.linalg.cholesky(gram), axis1=-2, axis2=-1)
    chi2 = np.maximum(pivots[..., -1] ** 2 - corner, 0.0)
    return Bordered(gram, chi2, 2 * np.log(pivots[..., :-1]).sum(axis=-1))
