"""Which poles of a fit the data bear out."""

from __future__ import annotations

import numpy as np
from scipy import stats

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from identification.fit.equations.refine import Fit

_FALSE_ALARM = 1e-8
# Standard deviations that half-width and damping of a mode must exceed: those just over the threshold of the strength
# have six where noise is what the weights imply. Twice as much strikes these; half as much lets flanks of noise pass.
_KNOWN = 3.0
_UNDAMPED = 1e-7  # damping ratio of nothing that vibrates


def constant_variance(fit: Fit) -> FloatArray:
    """Return the variance of the real part of each modal constant, shape (n_frf, n_modes) [1/kg^2].

    A = 2 i w R, so its real part is that of -2 w Im R. Poles' uncertainty is included. The imaginary part has
    the same variance unless the mode is near the residual terms, as the first of a band that starts at zero.
    """
    if fit.residue_variance is not None:
        return np.asarray((2.0 * fit.poles.imag) ** 2 * fit.residue_variance)
    gain = fit.pole_gain
    by_poles = np.einsum("jka,ab,jkb->jk", gain, pole_covariance(fit), gain, optimize=True)
    return np.asarray(
        (2.0 * fit.poles.imag) ** 2 * (fit.residue_inverse[:, 1::2] + np.maximum(by_poles, 0.0))
    )


def pole_covariance(fit: Fit) -> FloatArray:
    """Return the covariance of (Re, Im) of the poles, interleaved, (2 n_modes, 2 n_modes) [rad^2/s^2].

    Poles that the data do not determine, to rounding, get the variance of that rounding and no correlation.
    """
    return inverse_information(fit.information)


def inverse_information(information: FloatArray) -> FloatArray:
    """Return the inverse of an information matrix, unit columns first; as :func:`pole_covariance`."""
    diagonal = np.diag(information)
    floor = 1e-16 * diagonal.max(initial=0.0) + np.finfo(float).tiny
    seen = np.flatnonzero(diagonal > floor)
    length = np.sqrt(diagonal[seen])
    values, vectors = np.linalg.eigh(information[np.ix_(seen, seen)] / np.outer(length, length))
    sure = values > 1e-13 * values[-1]
    half = vectors[:, sure] / np.sqrt(values[sure]) / length[:, None]
    covariance = np.diag(np.full(len(diagonal), 1.0 / floor))
    covariance[np.ix_(seen, seen)] = half @ half.T
    return covariance


def strength(fit: Fit) -> FloatArray:
    """Return how far every mode stands out: sum |R|^2 / (variance of its parts), shape (n_modes,) [-].

    Without the mode it would be a chi-square of 2 n_frf degrees of freedom.
    """
    held = fit.residue_inverse.reshape(*fit.linear.residues.shape, 2).mean(axis=2)
    return np.asarray(np.sum(np.abs(fit.linear.residues) ** 2 / held, axis=0))


def threshold(n_frf: int, n_lines: int) -> float:
    """Return the strength that noise does not reach, wherever on ``n_lines`` lines a pole is tried [-]."""
    return float(stats.chi2.isf(_FALSE_ALARM / n_lines, 2 * n_frf + 2))


def significant(fit: Fit, *, n_lines: int, inflation: FloatArray | float = 1.0) -> BoolArray:
    """Return which modes are significant, shape (n_modes,).

    ``inflation`` is the factor by which noise that fades over the record makes the residues' variances
    larger, see :func:`identification.fit.noise.window_shaped.inflation`.
    """
    return np.asarray(strength(fit) > threshold(len(fit.linear.residues), n_lines) * inflation)


def plausible(poles: ComplexArray, band: tuple[float, float]) -> BoolArray:
    """Return which poles can be modes or the flank of one, shape (n_modes,).

    In reach: within one band width of the band, damping ratio above -0.1 and under 35 %.
    """
    width = band[1] - band[0]
    frequency, size = np.abs(poles) / (2 * np.pi), np.abs(poles)
    near = (frequency > band[0] - width) & (frequency < band[1] + width)
    return np.asarray(near & (-poles.real < 0.35 * size) & (poles.real < 1e-3 * size))


def located(poles: ComplexArray, spread: FloatArray, modes: BoolArray) -> BoolArray:
    """Return which modes are somewhere, shape (n_modes,): noise fitted by a pole is not.

    The frequency is known to a third of the half-power half-width and to half the distance of the next mode, the
    damping ratio to a third of itself: a mode that is barely significant has a sixth. A strong mode may miss them
    too, where lines are too far apart to determine its damping: this concerns modes that hardly stand out.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    spread : (n_modes, 2, 2) array
        Covariance of (ln frequency, damping ratio) [-].
    modes : (n_modes,) bool array
        Which poles are modes of the band.
    """
    sigma = np.abs(poles) * np.sqrt(spread[:, 0, 0])
    distance = np.abs(poles[:, None] - poles[None, :]) + np.where(modes[None, :], 0.0, np.inf)
    np.fill_diagonal(distance, np.inf)
    resolved = (_KNOWN * sigma < -poles.real) & (sigma < 0.5 * distance.min(axis=1, initial=np.inf))
    damped = -poles.real / np.abs(poles) > _KNOWN * np.sqrt(spread[:, 1, 1])
    return np.asarray(resolved & damped)


def inside(poles: ComplexArray, band: tuple[float, float], df: float) -> BoolArray:
    """Return which poles are modes of the band, shape (n_modes,).

    Their damped frequency lies in it, their ratio is above 1e-7 and under 20 %, and their half-power band is
    narrower than half the band: what is broader is a background.
    """
    frequency = poles.imag / (2 * np.pi)
    width = -2 * poles.real / (2 * np.pi)
    within = (frequency >= band[0] - 0.5 * df) & (frequency <= band[1] + 0.5 * df)
    light = (-poles.real < 0.2 * np.abs(poles)) & (-poles.real > _UNDAMPED * np.abs(poles))
    return np.asarray(within & light & (width > 0) & (width < 0.5 * (band[1] - band[0])))
