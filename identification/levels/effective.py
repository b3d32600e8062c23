"""Effective levels of hits: what all modes show together of how hard each was.

The largest force of a record gives how hard a structure was hit only up to the length of the pulse and to what a
filter makes of it; some per cent remain, the same for all modes of a hit. A line fitted over such levels is too flat
by the share of their error in their scatter (Fuller, Measurement Error Models, 1987, section 1.1), more so where the
hits that moved most were left out. Two modes that follow the force determine the level of a hit far better than its
record does, but for their scale, which the records have in the mean: levels are regressed on what the modes show.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from acquisition.arrays import FloatArray, IntArray
from identification.fit.noise.disagreement import student_widening

ROUNDS = 3
"""Fits of the curve, each with the error of the records that the one before left [-]. More change a level by less than
its error."""


@dataclass(frozen=True, eq=False)
class EffectiveLevels:
    """Levels of hits by their records and their modes.

    Parameters
    ----------
    levels : (n_hits,) array
        The level of each hit, on the scale of the records [N].
    scale_sigma : float
        Relative standard deviation of their scale, widened for its degrees of freedom [-].
    """

    levels: FloatArray
    scale_sigma: float


def effective_levels(
    levels: FloatArray,
    common: float,
    point: IntArray,
    shifts: FloatArray,
    variances: FloatArray,
    slope: FloatArray,
    *,
    bent: float,
) -> EffectiveLevels:
    """Return the levels of hits by records and modes.

    Parameters
    ----------
    levels : (n_hits,) array
        As recorded [N].
    common : float
        The level that averages stand for [N].
    point : (n_hits,) int array
        Point of each hit, from 0.
    shifts, variances : (n_hits, n_modes) arrays
        ln f of the modes that follow the level, and its variance by the misfit of each hit [-].
    slope : (n_modes,) array
        d ln f / dF of these modes by a line over the recorded levels [1/N].
    bent : float
        How far the slope may change over the common level, relative to itself, 1 sigma [-].
    """
    shown, noise = _shown(levels, point, shifts, variances, slope)
    freedom = len(levels) - int(point.max()) - 2
    if shifts.shape[1] < 2 or freedom < 1:
        return EffectiveLevels(levels, 0.0)
    size, away = np.clip(shown, levels.min(), levels.max()), shown - common
    basis = np.stack([away, away**2 / common, levels], axis=1)
    fit = np.array([1.0, 0.0])
    for _ in range(ROUNDS):
        left = levels - basis[:, :2] @ fit
        left = left - _means(left[:, None], point, 1 / size**2)[:, 0]
        of_shown = fit[0] ** 2 * noise
        share = np.median((left / size) ** 2) / stats.chi2.median(1) - np.median(of_shown / size**2)
        of_records = max(float(share), 0.0) * size**2
        weight = 1 / (of_records + of_shown)
        about = basis - _means(basis, point, weight)
        curve, recorded = about[:, :2], about[:, 2]
        normal = curve.T @ (weight[:, None] * curve) + np.diag([0.0, 4 / bent**2])
        known = normal - np.diag([np.sum(weight * noise), 0.0])
        fit = np.linalg.solve(known, curve.T @ (weight * recorded))
    left = recorded - curve @ fit
    part = of_records * weight
    error = max(float(np.sum(weight * left**2)) / freedom, 1.0)
    sigma = np.sqrt(student_widening(freedom) * error * np.linalg.inv(normal)[0, 0]) / fit[0]
    return EffectiveLevels(levels - part * left, float(sigma * np.median(part)))


def _shown(
    levels: FloatArray, point: IntArray, shifts: FloatArray, variances: FloatArray, slope: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the levels that the modes show about the mean of each point, and their variances, (n_hits,) [N, N^2]."""
    weight = slope**2 / variances
    about = (shifts - _means(shifts, point, 1 / variances)) / slope
    total = weight.sum(axis=1)
    own = np.sum(weight * about, axis=1) / total
    # modes that disagree on a hit beyond its misfit determine its level the less
    scale = np.sum(weight * (about - own[:, None]) ** 2, axis=1) / max(shifts.shape[1] - 1, 1)
    return own + _means(levels[:, None], point, np.ones(len(levels)))[:, 0], np.maximum(scale, 1.0) / total


def _means(values: FloatArray, point: IntArray, weight: FloatArray) -> FloatArray:
    """Return each value's weighted mean over its point, (n_hits, n)."""
    wide = np.broadcast_to(weight if weight.ndim == 2 else weight[:, None], values.shape)
    member = (point[:, None] == np.arange(point.max() + 1)).astype(np.float64)
    return np.asarray(
        member @ ((member.T @ (wide * values)) / np.maximum(member.T @ wide, np.finfo(float).tiny))
    )
