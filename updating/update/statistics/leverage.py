"""Which share of each datum the parameters take up."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.update.data.system import Linear, System
from updating.update.gauss_newton import NEGLIGIBLE


def leverage(system: System, linear: Linear) -> FloatArray:
    """Return the diagonal of the matrix that takes weighted data to their fit, tolerances held, (n,) [-].

    Together the rest is what is expected of the squared residuals, over their variances.
    """
    rows = np.sqrt(linear.weight)[:, None] * linear.sensitivity * system.doubt
    normal = rows.T @ rows + np.diag(system.prior * system.doubt**2)
    inverse = np.linalg.pinv(normal, rcond=NEGLIGIBLE, hermitian=True)
    return np.asarray(np.einsum("ij,jk,ik->i", rows, inverse, rows))
