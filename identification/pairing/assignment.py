"""Which mode of the test is which mode of the model; 'none' is an answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import AnyArray, FloatArray
from acquisition.errors import InputError
from identification.pairing.sequence import in_order

_RANGE = np.log(1.6)
_SLACK = 0.25


@dataclass(frozen=True)
class Pair:
    """A test mode and the model mode that is the same.

    Parameters
    ----------
    test, model : int
        Numbers of the modes, counted from 0.
    mac : float
        MAC of their shapes; nan without shapes [-].
    error : float
        Model frequency over test frequency, minus 1 [-].
    """

    test: int
    model: int
    mac: float
    error: float


def pair(
    test_frequency: AnyArray,
    model_frequency: AnyArray,
    mac_matrix: AnyArray | None = None,
    *,
    min_mac: float = 0.5,
    max_factor: float = 2.5,
    spread: float = 0.1,
) -> tuple[Pair, ...]:
    """Pair modes by the best assignment of all at once.

    With a MAC matrix the assignment minimises (1 - MAC) + a price of the distance in frequency of 0.6 at the
    most. All frequencies may be off by one factor: water, or a wrong modulus. So the distance counts from the
    factor that pairs of good MAC have in common. Two modes that stay alone cost (1 - ``min_mac``) + 0.25
    together: a pair of doubtful MAC must agree in frequency, one of MAC 0.85 (at the default) need not.
    Without shapes, or with nan for every MAC, the pairs keep the order of frequency, and dynamic programming
    finds the factor and the gaps of the cheapest sequence.

    Parameters
    ----------
    test_frequency : (n_test,) array
        Frequencies of the test [Hz].
    model_frequency : (n_model,) array
        Frequencies of the model [Hz].
    mac_matrix : (n_test, n_model) array, optional
        MAC of every test shape with every model shape [-].
    min_mac : float
        MAC under which two modes are no partners [-].
    max_factor : float
        Largest common factor between the frequencies, either way [-].
    spread : float
        Relative scatter of the frequencies about that factor that is nothing unusual [-].

    Returns
    -------
    tuple of Pair
        Rising by test mode.

    Raises
    ------
    InputError
        If a frequency is not positive or the MAC matrix does not fit.

    Notes
    -----
    Assignment: Kuhn, Naval Res. Logist. Q. 2 (1955) 83-97, through ``scipy.optimize.linear_sum_assignment``.
    """
    test, model = (np.atleast_1d(np.asarray(f, dtype=float)) for f in (test_frequency, model_frequency))
    if min(test.min(initial=1.0), model.min(initial=1.0)) <= 0:
        raise InputError("frequencies to be paired must be positive; leave rigid-body modes out")
    shift = np.log(model)[None, :] - np.log(test)[:, None]
    if test.size == 0 or model.size == 0:
        return ()
    if mac_matrix is None or np.all(np.isnan(np.asarray(mac_matrix, dtype=float))):
        found = in_order(test, model, np.log(max_factor), spread)
        values = np.full(shift.shape, np.nan)
    else:
        values = _of_modes(mac_matrix, shift)
        found = _by_shape(shift, values, min_mac, np.log(max_factor), spread)
    return tuple(Pair(i, j, float(values[i, j]), float(np.expm1(shift[i, j]))) for i, j in sorted(found))


def _of_modes(mac_matrix: AnyArray, shift: FloatArray) -> FloatArray:
    """Return a MAC matrix; refuse one that is not of the modes given."""
    values = np.asarray(mac_matrix, dtype=float)
    if values.shape != shift.shape:
        raise InputError(
            f"the MAC matrix has shape {values.shape}; {shift.shape[0]} test modes and {shift.shape[1]} model "
            "modes were given"
        )
    return values


def common_shift(shift: FloatArray, weight: FloatArray, limit: float, spread: float) -> float:
    """Return the logarithm of the factor most pairs have in common, by the mode of a weighted density.

    Parameters
    ----------
    shift : (n,) array
        ln(model / test) of pairs [-].
    weight : (n,) array
        Their weights [-].
    limit : float
        Largest logarithm to consider, either way [-].
    spread : float
        Width of the kernel [-].
    """
    near = np.abs(shift) <= limit + spread
    if not near.any() or not weight[near].max() > 0:
        return 0.0
    trial = np.unique(np.clip(shift[near], -limit, limit))
    density = np.exp(-0.5 * ((trial[:, None] - shift[None, near]) / spread) ** 2) @ weight[near]
    density = density * np.exp(-0.02 * np.abs(trial) / _RANGE)
    best = trial[density.argmax()]
    close = np.exp(-0.5 * ((best - shift) / spread) ** 2) * weight * near
    return float(np.sum(close * shift) / max(np.sum(close), np.finfo(float).tiny))


def common_factor(
    shift: FloatArray, values: FloatArray, min_mac: float, limit: float, spread: float
) -> float:
    """Return the logarithm of the factor that pairs which are each other's best by MAC have in common.

    Parameters
    ----------
    shift : (n_test, n_model) array
        ln(model / test) of the frequencies [-].
    values : (n_test, n_model) array
        MAC [-].
    min_mac, limit, spread : float
        Least MAC, largest logarithm either way, width of the kernel [-].
    """
    strong = (values == values.max(axis=1, keepdims=True)) & (values == values.max(axis=0, keepdims=True))
    weight = np.where(strong & (values >= min_mac), values**2, 0.0)
    return common_shift(shift.ravel(), weight.ravel(), limit, spread)


def _by_shape(
    shift: FloatArray, values: FloatArray, min_mac: float, limit: float, spread: float
) -> list[tuple[int, int]]:
    """Assign by MAC and by distance from the common factor, each mode free to stay alone."""
    centre = common_factor(shift, values, min_mac, limit, spread)
    distance = ((shift - centre) / (2.0 * spread)) ** 2
    price = (1.0 - values) + 0.5 * distance / (1.0 + distance)
    price = price + 0.1 * (1.0 - np.exp(-np.abs(shift - centre) / spread))
    allowed = (values >= min_mac) & (np.abs(shift - centre) <= limit)
    alone = 1.0 - min_mac + _SLACK
    return _assign(np.where(allowed, price, 4.0 * alone + 4.0), alone)


def _assign(price: FloatArray, alone: float) -> list[tuple[int, int]]:
    """Solve the assignment in which every mode may also stay alone for half the price ``alone``."""
    n_test, n_model = price.shape
    full = np.zeros((n_test + n_model, n_test + n_model))
    full[:n_test, :n_model] = price
    full[:n_test, n_model:] = alone / 2
    full[n_test:, :n_model] = alone / 2
    rows, columns = linear_sum_assignment(full)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if i < n_test and j < n_model]
