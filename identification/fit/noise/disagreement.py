"""FRFs that disagree on a pole by more than their noise, and what it does to its variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from acquisition.arrays import FloatArray

_CHANCE = 1e-3


@dataclass(frozen=True, eq=False)
class Disagreement:
    """Scatter of each pole between FRFs, beyond noise.

    Parameters
    ----------
    mean : (n_modes, 2, 2) array
        Variance it gives the common pole, (Re, Im), widened so that 1.96 standard deviations are a 95 % interval
        however few the FRFs are [rad^2/s^2].
    each : (n_frf, n_modes, 2, 2) array
        Variance of the pole of a single FRF about the one it was fitted with [rad^2/s^2].
    scatter : (n_modes, 2, 2) array
        Variance of the poles of single FRFs about the common one, beyond what was carried over [rad^2/s^2].
    """

    mean: FloatArray
    each: FloatArray
    scatter: FloatArray


def between_frfs(gradient: FloatArray, normal: FloatArray, expected: FloatArray) -> Disagreement:
    """Estimate how far the FRFs disagree on each pole.

    A hammer or a sensor that roves loads the structure differently at every point, and temperature drifts:
    every FRF then has poles of its own. Each FRF's gradient at the common fit shows where its own pole lies,
    N_j^-1 g_j away; 2 sum g_j^T N_j^-1 g_j is chi-square of 2 (n - 1) degrees of freedom if only noise moves
    them. Beyond one chance in a thousand the scatter is taken for real; how large it is follows from
    :func:`scatter_beyond_noise`.

    Parameters
    ----------
    gradient : (n_frf, n_modes, 2) array
        J^T r of each FRF for each pole [s/rad].
    normal : (n_frf, n_modes, 2, 2) array
        J^T J of the same [s^2/rad^2].
    expected : (n_modes,) array
        Factor by which the noise is known to exceed the weights [-].
    """
    n_frf, n_modes = gradient.shape[:2]
    variance = np.zeros((n_modes, 2))
    if n_frf < 2:
        none = variance[:, :, None] * np.eye(2)
        return Disagreement(none, none[None], none)
    inverse = np.linalg.pinv(normal, hermitian=True)
    own = np.einsum("jnab,jnb->jna", inverse, gradient)
    chi = 2.0 * np.einsum("jna,jna->n", gradient, own) / expected
    real = chi > stats.chi2.isf(_CHANCE, 2 * (n_frf - 1))
    held = 0.5 * np.einsum("jnaa->jna", inverse) * expected[:, None]
    seen = np.einsum("jnaa->jna", normal) > 0
    known = np.where(seen & (held > 0), held, np.inf)
    variance[real] = scatter_beyond_noise(own[:, real], known[:, real])
    wider = student_widening(_count(1.0 / (known + variance)) - 1.0)
    share = 1.0 / _count(np.einsum("jnaa->jn", normal))
    each = variance[:, :, None] * np.eye(2)
    mean = each * (wider * share[:, None])[:, :, None]
    return Disagreement(mean, np.tile(each, (n_frf, 1, 1, 1)), each)


def student_widening(freedom: FloatArray | float) -> FloatArray:
    """Return by what factor a variance is raised so that 1.96 standard deviations are a 95 % interval of Student's [-].

    Parameters
    ----------
    freedom : array or float
        Degrees of freedom of the variance; under 1 counts as 1 [-].
    """
    ratio = stats.t.ppf(0.975, np.maximum(freedom, 1.0)) / stats.norm.ppf(0.975)
    return np.asarray(ratio**2)


def _count(weight: FloatArray) -> FloatArray:
    """Return how many equal weights have the mean that weights along the first axis do, 1 or more (Kish, 1965) [-]."""
    squares = np.maximum(np.sum(weight**2, axis=0), np.finfo(float).tiny)
    return np.asarray(np.maximum(weight.sum(axis=0) ** 2 / squares, 1.0))


def scatter_beyond_noise(values: FloatArray, variance: FloatArray) -> FloatArray:
    """Return the variance between quantities measured with known variances, shape as one row of ``values``.

    It is the t for which sum (x_j - mean)^2 / (v_j + t) = n - 1, the mean weighted alike (Paule and Mandel,
    J. Res. Natl. Bur. Stand. 87 (1982) 377-385); 0 if the scatter is no larger than the variances imply.

    Parameters
    ----------
    values : (n, ...) array
        Measured values [any].
    variance : (n, ...) array
        Their variances; infinite where nothing was measured [any squared].
    """
    freedom = np.maximum(np.sum(np.isfinite(variance), axis=0) - 1, 1)

    def excess(between: FloatArray) -> FloatArray:
        weight = 1.0 / (variance + between)
        mean = np.sum(weight * values, axis=0) / np.maximum(weight.sum(axis=0), np.finfo(float).tiny)
        return np.asarray(np.sum(weight * (values - mean) ** 2, axis=0) - freedom)

    low = np.zeros(values.shape[1:])
    clean = np.where(np.isfinite(variance), values, 0.0)
    high = np.sum(clean**2, axis=0) + np.finfo(float).tiny
    for _ in range(60):
        middle = 0.5 * (low + high)
        above = excess(middle) > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.asarray(np.where(excess(np.zeros_like(low)) > 0, high, 0.0))
