"""How frequencies change from the first point of a roving test to the last: the trend of what each point shows alone.

While hammer or sensor go from point to point it gets warmer, cords creep, a clamp settles: the frequencies of the FRFs
follow their place in measuring order. Common poles are those in the middle of the test. What each set of FRFs that
were measured together gives for each frequency (:class:`identification.fit.drift.Drift`) is fitted by a line over that
order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.display import Displayed
from acquisition.frfs.frf import FrfSet
from identification.arrangement import arrange
from identification.fit.drift import Drift, measuring_order

SPARE = 1
"""Sets of FRFs beyond the coefficients of a line from which one is fitted [-]. Twice as many: tests of three points say
nothing of a trend; with one, its standard deviation is so wide that only a plain one shows."""

PLAIN = 3.0
"""So many standard deviations are what they are of a normal distribution [-]: few points scatter with long tails, and
what calls a drift one asks for more than twice. At 2, one test of three or four points in fifty drifts by chance; at 4,
tests of five show none."""

ROUNDS = 2
"""Fits of a line: the second weighs points by their scatter about the first beside their noise [-]. A third changes
little: weights may err by a fifth."""

LIGHT = 0.05
"""Half the mass of a sensor that roves over that of the structure, 1 sigma [-]: a heavier one is fixed, or no sensor.
Doubled: a trend over few points is known a little worse where the sensor goes from a clamp to a free end."""


@dataclass(frozen=True, eq=False)
class Trend(Displayed):
    """Relative change of frequencies from the first point to the last in measuring order, along a line.

    Parameters
    ----------
    value, sigma : (n_modes,) arrays
        Change of each mode, and the standard deviation of what it has for itself; nan where too few points show the
        mode [-].
    common_sigma : float
        Standard deviation of an error that all modes share: what all frequencies did together beside the line [-].
    setups : int
        Number of sets of FRFs that were measured one after the other.
    """

    value: FloatArray
    sigma: FloatArray
    common_sigma: float
    setups: int

    @property
    def rate(self) -> float:
        """The change that all modes have in common, each weighted by how well it is known; nan where none is [-]."""
        known = np.isfinite(self.sigma)
        weight = self.sigma[known] ** -2.0
        return float(weight @ self.value[known] / weight.sum()) if known.any() else np.nan

    @property
    def rate_sigma(self) -> float:
        """Its standard deviation; infinite where no mode shows a change [-]."""
        known = np.isfinite(self.sigma)
        if not known.any():
            return np.inf
        return float(np.hypot(np.sum(self.sigma[known] ** -2.0) ** -0.5, self.common_sigma))

    def _headline(self) -> str:
        return f"{100 * self.rate:+.2g} % +- {100 * self.rate_sigma:.2g} % over {self.setups} points"


def frequency_trend(frfs: FrfSet, drift: Drift, constants: ComplexArray) -> Trend | None:
    """Return how frequencies change over a test, or None where it does not rove over enough points to tell.

    Parameters
    ----------
    frfs : FrfSet
        FRFs in the order in which they were measured; those of the same hits, or of one point of the side that
        roves, were measured together.
    drift : Drift
        What each of them shows of the frequencies, at the poles of the modes.
    constants : (n_frf, n_modes) complex array
        Modal constants, by which a roving sensor loads each mode [1/kg].

    Notes
    -----
    Standard deviations come from the scatter about the lines, widened for its degrees of freedom so that ``PLAIN`` of
    them are exceeded as seldom as of a normal distribution; noise alone is their least. A sensor that roves lowers
    each frequency in proportion to its mass and to the square of the mode where it sits (Rayleigh): that is fitted
    beside the line.
    """
    order = measuring_order(frfs)
    _, rows = np.unique(order, return_index=True)
    design = _design(len(rows), constants.shape[1])
    if not arrange(frfs).transposed:
        design = np.concatenate([design, _load(constants, order).T[:, :, None]], axis=2)
    known = np.isfinite(drift.raw_variance[rows]).sum(axis=0) >= design.shape[2] + SPARE
    if not known.any():
        return None
    value, sigma = np.full((2, len(known)), np.nan)
    shifts, variance = drift.raw[rows].T[known], drift.raw_variance[rows].T[known]
    value[known], sigma[known], common = _lines(shifts, variance, design[known])
    return Trend(value, sigma, common, len(rows))


def _load(constants: ComplexArray, order: IntArray) -> FloatArray:
    """Return the square of each mode where the sensor sits in each set of FRFs, over its mean, (n_groups, n_modes)."""
    square = np.zeros((int(order.max()) + 1, constants.shape[1]))
    np.add.at(square, order, np.abs(constants) ** 2)
    square /= np.bincount(order)[:, None]
    return np.asarray(square / np.maximum(square.mean(axis=0), np.finfo(float).tiny))


def _design(count: int, n_modes: int) -> FloatArray:
    """Return the columns of a line: its mean, and the place in the test from -1/2 to 1/2, (n_modes, n_groups, 2)."""
    place = np.linspace(-0.5, 0.5, count)
    return np.tile(np.stack([np.ones(count), place], axis=1), (n_modes, 1, 1))


def _lines(
    shifts: FloatArray, variance: FloatArray, design: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return slope and standard deviation of each mode's line, and that of the error all share.

    Parameters
    ----------
    shifts, variance : (n_modes, n_groups) arrays
        What is fitted, and the variance of its noise, infinite where there is nothing [-].
    design : (n_modes, n_groups, n) array
        Columns of the lines [-].
    """
    seen = np.isfinite(variance)
    noise = np.where(seen, variance, 0.0)
    freedom = seen.sum(axis=1) - design.shape[2]
    floor = np.nanmedian(np.where(seen, noise, np.nan), axis=1)  # no point rules alone
    for _ in range(ROUNDS):
        weight = np.where(seen, 1.0 / (noise + floor[:, None]), 0.0)
        gain, own = _gain(design, weight)
        left = _beside(design, gain, shifts)
        alike = _common(weight, left) / (1.0 - design.shape[2] / design.shape[1])
        course, known = _course(weight, left, alike)
        # each mode weighs points differently: what all modes did beside the line would change each slope differently
        along = np.where(seen, shifts - course, 0.0)
        square = np.sum(weight * _beside(design, gain, along) ** 2, axis=1)
        floor = np.maximum(floor, square / weight.sum(axis=1))
    slope, wider = gain[:, 1], (stats.t.isf(stats.norm.sf(PLAIN), freedom) / PLAIN) ** 2
    spread = square / (freedom * (1.0 - known / len(shifts))) * own
    least = np.sum(slope**2 * noise, axis=1)
    variance = np.maximum(wider * spread, least)
    mean = (slope / variance[:, None]).sum(axis=0) / np.sum(1.0 / variance)
    common = float(np.sqrt((wider * alike).min() * np.sum(mean**2)))
    return np.sum(slope * along, axis=1), np.sqrt(variance), common


def _beside(design: FloatArray, gain: FloatArray, shifts: FloatArray) -> FloatArray:
    """Return how far shifts lie from their lines, (n_modes, n_groups)."""
    return np.asarray(shifts - np.einsum("rgn,rnh,rh->rg", design, gain, shifts))


def _course(weight: FloatArray, left: FloatArray, alike: float) -> tuple[FloatArray, float]:
    """Return what all modes did together beside their lines in each set of FRFs, (n_groups,), and how well it is known.

    Parameters
    ----------
    weight, left : (n_modes, n_groups) arrays
        Inverse variance, and distance from the line [-].
    alike : float
        Variance of it from set to set [-].
    """
    whole = np.maximum(weight.sum(axis=0), np.finfo(float).tiny)
    known = alike / (alike + 1.0 / whole)
    return np.asarray(known * np.sum(weight * left, axis=0) / whole), float(known.mean())


def _gain(design: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how coefficients follow from shifts, (n_modes, n, n_groups), and each slope's variance, (n_modes,)."""
    weighted = (design * weight[:, :, None]).transpose(0, 2, 1)
    normal = weighted @ design
    normal[:, 2:, 2:] += LIGHT**-2.0
    inverse = np.linalg.inv(normal)
    return np.asarray(inverse @ weighted), np.asarray(inverse[:, 1, 1])


def _common(weight: FloatArray, left: FloatArray) -> float:
    """Return the variance, from set to set of FRFs, of what all modes do together beside their lines [-].

    It is what the products of different modes' distances have in common, 0 for one mode.
    """
    apart = weight * left
    products = np.sum(apart.sum(axis=0) ** 2 - np.sum(apart**2, axis=0))
    pairs = np.sum(weight.sum(axis=0) ** 2 - np.sum(weight**2, axis=0))
    return float(max(products / pairs, 0.0)) if pairs > 0 else 0.0
