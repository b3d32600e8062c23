"""What noise common to all outputs of a hit does to the variance of the poles.

Weights take the errors of all FRFs for independent. Where the force's noise moves them together, the poles err by
more: the same at every line for all outputs, it does not average out over them. The sandwich of both
covariances (White, Econometrica 48 (1980) 817-838) is formed here from the law of the noise, not from the hits.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.projection import pole_turns
from identification.fit.equations.pruning import inverse_information
from identification.fit.equations.refine import Fit
from identification.fit.noise.common import common_noise, direction


def common_factors(
    frfs: FrfSet, fit: Fit, weights: normal_equations.Weights, variance: FloatArray, residual: ComplexArray
) -> FloatArray:
    """Return by what factor common noise raises the variance of each pole, shape (n_modes,) [-], 1 or more.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    fit : Fit
        A fit to them.
    weights : Weights
        Reciprocal variances it was made with.
    variance : (n_frf, n_lines) array
        Noise variance of every value [unit of the FRFs squared].
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    """
    n = len(fit.poles)
    way = direction(frfs, fit.poles, fit.linear)
    noise = common_noise(frfs, way, residual, variance)
    if not any(b.any() for b in noise.variance):
        return np.ones(n)
    columns = basis.build(basis.Axis.of(frfs), fit.poles, fit.linear.powers)
    extra = np.zeros((2 * n, 2 * n))
    for rows, b in zip(noise.groups, noise.variance, strict=True):
        capped = np.minimum(
            b, 1.0 / np.maximum((np.abs(way[rows]) ** 2 / variance[rows]).max(axis=0), 1e-300)
        )
        together, alone = pulls(fit, weights, columns, rows, way[rows])
        half = np.sqrt(capped)[:, None] * together
        extra += (half.conj().T @ half).real - np.diag(capped @ alone)
    inverse = inverse_information(fit.equations.step.normal)
    added = np.einsum("ab,bc,ca->a", inverse, extra, inverse) / np.diag(inverse)
    return np.asarray(np.maximum(1.0 + added, 1.0).reshape(n, 2).mean(axis=1))


def pulls(
    fit: Fit, weights: normal_equations.Weights, columns: basis.Basis, rows: IntArray, model: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """Return what a unit of common noise at each line pulls the poles by, (n_lines, 2 n_modes).

    Also the squares of what it would if it were independent in each FRF, summed over these.
    """
    n = len(fit.poles)
    residues = fit.linear.residues[rows]
    turns = pole_turns(np.stack([residues.real, residues.imag], axis=2).reshape(len(rows), -1), n)
    size = weights.level[rows, None] * model
    if len(weights.lines) == 1:
        return _pull(_free_slopes(columns, fit.equations.follow[0], weights.lines[0]), turns, size)
    together = np.zeros((model.shape[1], 2 * n), np.complex128)
    alone = np.zeros((model.shape[1], 2 * n))
    for j, row in enumerate(rows):
        slopes = _free_slopes(columns, fit.equations.follow[row], weights.lines[row])
        own = _pull(slopes, turns[[j]], size[[j]])
        together += own[0]
        alone += own[1]
    return together, alone


def _free_slopes(columns: basis.Basis, follow: FloatArray, lines: FloatArray) -> ComplexArray:
    """Return the conjugate slopes times weights, (n_lines, 2 n_modes), the linear columns projected out.

    Parameters
    ----------
    columns : Basis
        The columns.
    follow : (n_linear, 2 n_modes) array
        How the linear unknowns follow the slopes.
    lines : (n_lines,) array
        Weights [-].
    """
    return np.asarray(lines[:, None] * (columns.slopes - columns.linear @ follow).conj())


def _pull(slopes: ComplexArray, turns: FloatArray, size: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Return what FRFs that share their slopes pull together, and the sum of squares of what each does alone.

    Parameters
    ----------
    slopes : (n_lines, 2 n_modes) complex array
        As of :func:`_free_slopes`.
    turns : (n_frf, n_modes, 2, 2) array
        From (Re, Im) of a pole to weights of its two slopes.
    size : (n_frf, n_lines) complex array
        The FRFs times their level.

    Returns
    -------
    (n_lines, 2 n_modes) complex array and (n_lines, 2 n_modes) array
    """
    n_lines, n = len(slopes), turns.shape[1]
    pairs = slopes.reshape(n_lines, n, 2)
    mean = (size.T @ turns.reshape(len(turns), -1)).reshape(n_lines, n, 2, 2)
    products = np.einsum("jnia,jnka->jnika", turns, turns).reshape(len(turns), -1)
    spread = ((np.abs(size) ** 2).T @ products).reshape(n_lines, n, 2, 2, 2)
    crossed = (pairs[:, :, :, None] * pairs[:, :, None, :].conj()).real
    together = np.einsum("lni,lnia->lna", pairs, mean)
    alone = np.einsum("lnik,lnika->lna", crossed, spread)
    return together.reshape(n_lines, 2 * n), alone.reshape(n_lines, 2 * n)
