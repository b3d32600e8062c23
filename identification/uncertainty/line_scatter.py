"""What the residual at each line says of the variance of the poles, where errors go together over lines and FRFs.

Averages over windowed blocks err at a line and its neighbours, and in all outputs of a force, by the same: what rings
into a block and out of it is of the mode, not of the output. The sum over the lines of what each pulls the poles by,
its neighbours' products included, is the covariance of the fit (Newey and West, Econometrica 55 (1987) 703-708, over
lines; Liang and Zeger, Biometrika 73 (1986) 13-22, over outputs)."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from identification.fit.equations import basis
from identification.fit.equations.pruning import inverse_information
from identification.fit.fit import Fitted
from identification.fit.noise.common import hit_groups
from identification.fit.noise.common_spread import pulls

LAGS = 4
"""Lines over which errors go together at the most: a Hann window ties two on either side. Doubled, few lines of a
narrow peak tell less of its scatter."""


def line_factors(fitted: Fitted) -> FloatArray:
    """Return by what factor the scatter of the lines raises the variance of each pole, (n_modes,) [-], 1 or more.

    The few lines of one peak know their scatter poorly: a mode's factor is never under the mean of all.

    Parameters
    ----------
    fitted : Fitted
        The fit.
    """
    frfs, fit = fitted.frfs, fitted.fit
    columns = basis.build(basis.Axis.of(frfs), fit.poles, fit.linear.powers)
    spread = np.zeros((2 * len(fit.poles), 2 * len(fit.poles)))
    grouped = hit_groups(frfs) or tuple(np.array([row]) for row in range(len(frfs.values)))
    for rows in grouped:
        together, _ = pulls(fit, fitted.weights, columns, rows, fitted.residual[rows])
        line = together.real
        spread += line.T @ line
        for lag in range(1, LAGS + 1):
            product = line[:-lag].T @ line[lag:]
            spread += (1.0 - lag / (LAGS + 1.0)) * (product + product.T)
    inverse = inverse_information(fit.equations.step.normal)
    found = np.einsum("ab,bc,ca->a", inverse, spread, inverse) / (0.5 * np.diag(inverse))
    each = found.reshape(-1, 2).mean(axis=1)
    return np.asarray(np.maximum(each, max(1.0, float(each.mean()))))
