"""Variance of the poles from the residual at each line, where errors go together over lines and FRFs.

Averages over windowed blocks err at a line and its neighbours, and in all outputs of a force, by the same: what rings
into a block and out of it is of the mode, not of the output. The sum over the lines of what each pulls the poles by,
its neighbours' products included, is the covariance of the fit (Newey and West, Econometrica 55 (1987) 703-708, over
lines; Liang and Zeger, Biometrika 73 (1986) 13-22, over outputs).

Lines smoothed by a quarter, a half and a quarter have noise that was smoothed with them, or noise that came after, or
both. The law of either is known; how much there is of each follows from the residual: what a fit leaves of few lines
has itself lost what the fit took for the modes. What outputs have in common is in the first sum alone: the larger
counts.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from identification.fit.equations import basis
from identification.fit.equations.pruning import inverse_information
from identification.fit.fit import Fitted
from identification.fit.noise.common import hit_groups
from identification.fit.noise.common_spread import pulls

LAGS = 4
"""Lines over which errors go together at the most: a Hann window ties two on either side. Doubled, few lines of a
narrow peak determine less of its scatter."""

SMOOTHED = (1.0, 2 / 3, 1 / 6)
"""Correlation of smoothed white noise at a line with that at the same, the next and the one after it [-]."""


def line_factors(fitted: Fitted) -> FloatArray:
    """Return by what factor the scatter of the lines raises the variance of each pole, (n_modes,) [-], 1 or more.

    The few lines of one peak determine their scatter poorly: a mode's factor is never under the mean of all.

    Parameters
    ----------
    fitted : Fitted
        The fit.
    """
    shape = fitted.frfs.line_shape
    laws = (_of_averaged, _of_smoothed) if shape is not None and shape.kind == "smoothed" else (_of_averaged,)
    inverse = inverse_information(fitted.fit.equations.step.normal)
    found = [np.einsum("ab,bc,ca->a", inverse, law(fitted), inverse) for law in laws]
    each = (np.max(found, axis=0) / (0.5 * np.diag(inverse))).reshape(-1, 2).mean(axis=1)
    return np.asarray(np.maximum(each, max(1.0, float(each.mean()))))


def _of_averaged(fitted: Fitted) -> FloatArray:
    """Return the covariance of what the residual at all lines pulls the poles by, (2 n_modes, 2 n_modes)."""
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
    return spread


def _of_smoothed(fitted: Fitted) -> FloatArray:
    """Return the covariance of what white and smoothed noise pull the poles by, (2 n_modes, 2 n_modes)."""
    fit = fitted.fit
    columns = basis.build(basis.Axis.of(fitted.frfs), fit.poles, fit.linear.powers)
    white, smoothed = _levels(fitted, columns.linear)
    spread = np.zeros((2 * len(fit.poles), 2 * len(fit.poles)))
    for row in range(len(fitted.residual)):
        rows = np.array([row])
        line, _ = pulls(fit, fitted.weights, columns, rows, np.sqrt(fitted.variance[rows]) + 0j)
        spread += 0.5 * (line.conj().T @ (white * line + smoothed * _smooth(line))).real
    return spread


def _levels(fitted: Fitted, columns: ComplexArray) -> tuple[float, float]:
    """Return the powers of white and of smoothed noise over the variance, from products of residuals [-].

    A fit takes the noise along its linear columns: with M what it leaves, noise of covariance L gives the residual
    M L M, the trace of which is its power, and that one line aside the sum of its products.

    Parameters
    ----------
    fitted : Fitted
        The fit.
    columns : (n_lines, n) complex array
        Its linear columns.
    """
    left = fitted.residual / np.sqrt(fitted.variance)
    scaled = columns / np.sqrt(fitted.variance.mean(axis=0))[:, None]
    scaled = scaled / np.maximum(np.linalg.norm(scaled, axis=0), np.finfo(float).tiny)
    half = np.linalg.svd(np.concatenate([scaled.real, scaled.imag]), full_matrices=False)[0]
    taken = half.reshape(2, len(columns), -1).transpose(1, 0, 2)
    n_lines = len(columns)
    if 2 * n_lines <= taken.shape[2] + 1:  # nothing is left of them
        return 1.0, 0.0

    def crossed(one: FloatArray, other: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("lca,lcb->ab", one, other))

    aside = np.zeros_like(taken)
    aside[:-1] += 0.5 * taken[1:]
    aside[1:] += 0.5 * taken[:-1]
    even, next_to = crossed(taken, _smooth(taken)), crossed(taken, aside)
    both = crossed(aside, _smooth(taken))
    expected = np.array(
        [
            [2 * n_lines - len(even), 2 * n_lines - np.trace(even)],
            [
                -np.trace(next_to),
                2 * SMOOTHED[1] * (n_lines - 1) - 2 * np.trace(both) + np.sum(next_to * even),
            ],
        ]
    )
    n_frf = len(left)
    seen = np.sum(np.abs(left) ** 2), np.sum((left[:, :-1].conj() * left[:, 1:]).real)
    white, smoothed = np.linalg.solve(expected, 2.0 * np.array(seen) / n_frf)
    if smoothed < 0.0:
        return 1.0, 0.0
    if white < 0.0:
        return 0.0, 2.0 * float(seen[0]) / n_frf / float(expected[0, 1])
    return float(white), float(smoothed)


def _smooth(values: np.ndarray) -> np.ndarray:
    """Return the covariance of smoothed noise, its diagonal 1, times values over the lines, shape as ``values``."""
    found = np.array(values)
    for lag in (1, 2):
        found[:-lag] += SMOOTHED[lag] * values[lag:]
        found[lag:] += SMOOTHED[lag] * values[:-lag]
    return found
