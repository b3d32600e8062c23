"""Noise that fades along the record, as an exponential window makes it, and what it does to the evidence.

Noise whose variance falls as exp(-2 w t) over a record of length T has spectral lines that go together: the
correlation m lines apart is 1 / (1 - i pi m / (w T)) for a record that holds the whole decay. Lines then
scatter less from one to the next than they err, and a pole, whose response exp(p t) lives where the noise
is, is known less well than independent lines of that variance would have it.
"""

from __future__ import annotations

from math import comb

import numpy as np
from scipy import optimize

from acquisition.arrays import ComplexArray, FloatArray
from identification.fit.noise.differences import power_of_differences

STRONGEST = 40.0
"""Largest decay w T of noise over a record that its lines show [-]."""

_PIECE = 16
_CERTAIN = 2.0  # four standard deviations of the ratio below, for steady noise


def roughness(fade: float, order: int) -> float:
    """Return the mean square of the differences of window-shaped noise over that of as strong a steady noise [-].

    Parameters
    ----------
    fade : float
        Decay w T of the noise over the record [-].
    order : int
        Order of the differences, normalised to leave white noise as it is [-].
    """
    if fade == 0.0:
        return 1.0
    lag = np.arange(1, order + 1)
    share = np.array([(-1.0) ** k * comb(2 * order, order + k) for k in lag]) / comb(2 * order, order)
    return float(1.0 + 2.0 * share @ (1.0 / (1.0 + (np.pi * lag / fade) ** 2)))


def decay_over_record(residual: ComplexArray) -> float:
    """Return how far the noise in residuals fades over the record, w T [-]; 0 unless it surely does.

    Second differences of such noise are larger, against fourth ones, than of steady noise. Being
    differences, and a median over stretches of lines, they hardly see what a model still lacks.

    Parameters
    ----------
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    """
    ratio = ratio_of_differences(residual)
    return 0.0 if ratio is None else _fade(ratio, residual.size)


def ratio_of_differences(residual: ComplexArray) -> float | None:
    """Return the mean square of second differences over that of fourth ones, None of too few lines [-].

    Parameters
    ----------
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    """
    if residual.shape[1] < 4 * _PIECE:
        return None
    second, fourth = _pieces(residual, 2), _pieces(residual, 4)
    level = np.median(fourth, axis=1, keepdims=True)
    level = np.maximum(level, np.finfo(float).tiny + 1e-12 * level.max())
    return float(np.median(np.sum(second / level, axis=0) / np.sum(fourth / level, axis=0)))


def steepness(fade: float) -> float:
    """Return that ratio of noise that decays so far, w T, over the record [-]."""
    return roughness(fade, 2) / roughness(fade, 4)


def _pieces(residual: ComplexArray, order: int) -> FloatArray:
    """Return mean squares of differences over stretches of lines, shape (n_frf, n_pieces)."""
    edge = (4 - order) // 2  # the same lines for both orders
    rough = power_of_differences(residual[:, edge : residual.shape[1] - edge], order)
    power = rough[:, : rough.shape[1] // _PIECE * _PIECE]
    return np.asarray(np.maximum(power.reshape(len(power), -1, _PIECE).mean(axis=2), np.finfo(float).tiny))


def _fade(ratio: float, n_values: int) -> float:
    if not ratio > 1.0 + _CERTAIN / np.sqrt(n_values):
        return 0.0

    def excess(fade: float) -> float:
        return steepness(fade) - ratio

    if excess(STRONGEST) < 0:
        return STRONGEST
    return float(optimize.brentq(excess, 1e-3, STRONGEST)) if excess(1e-3) < 0 else 0.0


def at_start(fade: float) -> float:
    """Return the noise power at the start of the record over its mean [-]: what a smooth term has to bear."""
    return 1.0 if fade == 0.0 else float(2.0 * fade / -np.expm1(-2.0 * fade))


def inflation(fade: float, decay: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return by what factor window-shaped noise makes variances larger than steady noise of the same power.

    A pole that decays by ``decay`` over the record is fitted by exp(-s t) for its residue and t exp(-s t)
    for itself; least squares with equal weights then has the covariance A^-1 B A^-1, where A holds the
    moments of exp(-2 s t) and B those of exp(-2 (s + w) t).

    Parameters
    ----------
    fade : float
        Decay w T of the noise over the record [-].
    decay : (n_modes,) array
        Decay s T of each mode over the record [-].

    Returns
    -------
    held : (n_modes,) array
        For residues with the poles held [-].
    free : (n_modes,) array
        For residues with the poles fitted too [-].
    pole : (n_modes,) array
        For the poles [-].
    """
    if fade == 0.0:
        one = np.ones(len(decay))
        return one, one, one
    steady = np.maximum(decay, 0.0)
    a, b = _moments(steady), at_start(fade) * _moments(steady + fade)
    inverse = np.linalg.inv(a)
    both = inverse @ b @ inverse
    factors = b[:, 0, 0] / a[:, 0, 0], both[:, 0, 0] / inverse[:, 0, 0], both[:, 1, 1] / inverse[:, 1, 1]
    held, free, pole = (np.maximum(f, 1.0) for f in factors)
    return held, free, pole


def _moments(decay: FloatArray) -> FloatArray:
    """Return the integrals of u^(i + j) exp(-2 decay u) from 0 to 1, scaled in u, shape (n, 2, 2)."""
    node, weight = np.polynomial.legendre.leggauss(64)
    reach = np.minimum(1.0, 20.0 / np.maximum(decay, 1e-9))[:, None]
    u = 0.5 * (node[None, :] + 1.0) * reach
    density = 0.5 * reach * weight * np.exp(-2.0 * decay[:, None] * u)
    m = [np.sum(density * u**k, axis=1) for k in range(3)]
    return np.stack([np.stack([m[0], m[1]], axis=1), np.stack([m[1], m[2]], axis=1)], axis=1)
