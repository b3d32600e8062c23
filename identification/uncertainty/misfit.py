"""How far what a fit leaves about each mode exceeds independent noise, and what that does to the mode's variance."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.fit import Fitted

_SURE = 3.0  # standard deviations beyond which an excess counts
_LEAST_LAGS, _MOST_LAGS = 4, 64


def misfit_factor(frfs: FrfSet, fitted: Fitted) -> FloatArray:
    """Return by what factor the misfit raises the variance of each pole, shape (n_modes,) [-], 1 or more.

    The square of Birge's ratio, as the misfit's power may exceed the noise's; times how many lines in a row err
    together, as a model that does not hold errs smoothly. Each counts only where it surely is no chance.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs that were fitted.
    fitted : Fitted
        The fit.
    """
    density = 1.0 / np.abs(frfs.laplace[None, :] - fitted.fit.poles[:, None]) ** 2
    return excess_power(fitted, density) * lines_together(frfs, fitted, density)


def excess_power(fitted: Fitted, density: FloatArray) -> FloatArray:
    """Return residual power over its variance, averaged as each mode's residue weighs the values, (n_modes,) [-].

    Parameters
    ----------
    fitted : Fitted
        The fit.
    density : (n_modes, n_lines) array
        Power of each mode's peak at the lines [s^2/rad^2].
    """
    share = np.abs(fitted.fit.linear.residues.T) ** 2
    ratio = np.abs(fitted.residual) ** 2 / fitted.variance
    free = np.broadcast_to(1.0 - fitted.absorbed, ratio.shape)
    inverse = 1.0 / fitted.variance
    over = np.einsum("rj,jk,rk->r", share, inverse * ratio, density, optimize=True)
    under = np.einsum("rj,jk,rk->r", share, inverse * free, density, optimize=True)
    spread = np.einsum("rj,jk,rk->r", share**2, inverse**2 * free, density**2, optimize=True)
    excess = over / under
    return np.asarray(np.where(excess > 1.0 + _SURE * np.sqrt(spread) / under, excess, 1.0))


def lines_together(frfs: FrfSet, fitted: Fitted, density: FloatArray) -> FloatArray:
    """Return over how many lines the residual about each mode errs alike, shape (n_modes,) [-], 1 or more.

    The sum of its correlations over lags of up to two half-power widths with Bartlett's weights (Newey and West,
    Econometrica 55 (1987) 703-708), over that of noise as it fades along the record, which is known apart.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs that were fitted.
    fitted : Fitted
        The fit.
    density : (n_modes, n_lines) array
        Power of each mode's peak at the lines [s^2/rad^2].
    """
    white = fitted.residual / np.sqrt(fitted.variance)
    width = 2.0 * np.abs(fitted.fit.poles.real - frfs.decay) / (2 * np.pi * frfs.df)
    most = max(1, min(_MOST_LAGS, white.shape[1] // 4))
    lags = np.clip(np.ceil(2.0 * width), _LEAST_LAGS, most).astype(np.int64)
    share = density / density.sum(axis=1, keepdims=True)
    power, *products = _correlations(white, int(lags.max()))
    together = np.ones(len(lags))
    expected = np.ones(len(lags))
    for lag, product in enumerate(products, start=1):
        weight = 2.0 * np.maximum(1.0 - lag / (lags + 1.0), 0.0)
        mean = share[:, : len(product)] @ product / (share @ power)
        together += weight * mean
        expected += weight * _of_window_shaped_noise(fitted.weights.fade, lag)
    values = len(white) / np.sum(share**2, axis=1)
    chance = _SURE * np.sqrt(4.0 / 3.0 * lags / values)
    ratio = together / expected
    return np.asarray(np.where(ratio > 1.0 + chance, ratio, 1.0))


def _correlations(white: ComplexArray, most: int) -> list[FloatArray]:
    """Return the mean products of values up to ``most`` lines apart over the FRFs, each (n_lines - lag,) [-].

    Products of blocks of lines with those after them, as matrix products of which a band is used, take a fifth of the
    time of one pass over the data for each lag.
    """
    count, n = white.shape
    parts = np.ascontiguousarray(white.T).view(np.float64)
    found = [np.empty(n - lag) for lag in range(most + 1)]
    for start in range(0, n, most + 1):
        own = parts[start : start + most + 1]
        products = own @ parts[start : start + 2 * most + 1].T / count
        for lag, values in enumerate(found):
            band = np.diagonal(products, lag)[: len(own)]
            values[start : start + len(band)] = band
    return found


def _of_window_shaped_noise(fade: float, lag: int) -> float:
    """Return the correlation over a lag [-] of noise that fades along the record (`fit.noise.window_shaped`)."""
    return 0.0 if fade == 0.0 else 1.0 / (1.0 + (np.pi * lag / fade) ** 2)
