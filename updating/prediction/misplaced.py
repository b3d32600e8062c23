"""What a hit or a sensor beside its place does to modal constants.

The constant of an FRF is c = g s h: the gain, the shape at the sensor, and the shape at the force. A hit beside its
point by dx changes it by g s h' dx, a sensor by g s' h dx. The slopes are the model's. So are the shapes, but for the
end that many FRFs share, which does not rove: near a node of it the model hardly determines how far a mode moves, for
the place of the transducer decides that. The measured constants determine it: with q = g h over the FRFs of one sensor,
s = sum(q c) / sum(q^2).

What slopes leave out is a half of (k dx)^2 of the shape, where k^2 = mean(h'^2) / mean(h^2) is the square of the wave
number. It is exact for waves sin(k x), which the shapes of uniform beams and plates are away from their ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured


class Moved(NamedTuple):
    """Derivatives of the constants by places.

    Parameters
    ----------
    constants : (n_frf, n_modes) array
        The constants themselves, of the shapes that the derivatives are of.
    first : (d, n_frf, n_modes) array
        Derivatives by the place of the hit, of the sensor where no force is known [constants per m]; then changes by
        which of several nodes at the point is meant [constants].
    sensor : (d, n_frf, n_modes) array
        Those by the place of the sensor where a force is known, else 0.
    """

    constants: FloatArray
    first: FloatArray
    sensor: FloatArray


def moved(test: Measured, now: Prediction, level: FloatArray, measured: FloatArray) -> Moved:
    """Return the derivatives of the constants by the places of hits and of sensors.

    Parameters
    ----------
    test : Measured
        Which points the FRFs join.
    now : Prediction
        The modes.
    level : (n_modes,) or (n_frf, n_modes) array
        What predicted constants are multiplied by [kg, or - where both have a unit].
    measured : (n_frf, n_modes) array
        The constants that they are to be.
    """
    bare = (test.hit < 0)[:, None]
    seen, hit = _as_measured(test, now, level, measured)
    factor = level * now.gain
    by_hit, by_sensor = factor * seen * now.hit_slopes, factor * hit * now.seen_slopes
    return Moved(factor * seen * hit, np.where(bare, by_sensor, by_hit), np.where(bare, 0.0, by_sensor))


def _as_measured(
    test: Measured, now: Prediction, level: FloatArray, measured: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the shapes at sensor and force, (n_frf, n_modes); where FRFs share one of them, as it was measured."""
    alike = test.sharing
    ends = {"seen": now.seen, "hit": now.hit}
    others = level * now.gain * ends[test.roving]
    power = alike @ others**2
    known = (np.sum(alike, axis=1) > 1)[:, None] & (power > 0)
    ends[test.fixed] = np.where(
        known, alike @ (others * measured) / np.where(known, power, 1.0), ends[test.fixed]
    )
    return ends["seen"], ends["hit"]


def best_levels(measured: FloatArray, predicted: FloatArray) -> FloatArray:
    """Return the factor that brings each predicted mode (n_frf, n_modes) nearest to the measured one, (n_modes,)."""
    power = np.maximum(np.sum(predicted**2, axis=0), np.finfo(float).tiny)
    return np.asarray(np.sum(measured * predicted, axis=0) / power)


def stated_levels(test: Measured, now: Prediction) -> FloatArray:
    """Return what predicted constants are multiplied by to be the test's, (n_modes,) [-].

    Where their level is measured it is one for all modes, their median: that of one mode whose sensor is near a node is
    unknown.
    """
    each = best_levels(test.constants, now.constants)
    if not test.absolute:
        return each
    signs = test.same_signs(now.constants)
    return np.asarray(np.median(signs * each) * signs)


def per_place(rank: IntArray, sigma: FloatArray, along: FloatArray) -> FloatArray:
    """Return what a standard deviation of each place changes, one column per point and direction, (n, n_places dim).

    Parameters
    ----------
    rank : (n_frf,) int array
        Which of the places each FRF has.
    sigma : (n_places, dim) array
        Doubt in each place [m].
    along : (dim, n_frf, n_modes) array
        Derivatives of the constants by it.
    """
    n_dim, n_frf, n_modes = along.shape
    columns = np.zeros((n_frf, n_modes, len(sigma), n_dim))
    columns[np.arange(n_frf), :, rank] = np.moveaxis(along * sigma[rank].T[:, :, None], 0, -1)
    return columns.reshape(n_frf * n_modes, -1)


def beyond_slopes(sigma: FloatArray | float) -> FloatArray:
    """Return the mean square of dx^2 / 2, by which shapes of curvature 1 leave their slopes, 3 sigma^4 / 4 [m^4].

    Parameters
    ----------
    sigma : array or float
        Standard deviation of dx [m].
    """
    return np.asarray(0.75 * np.asarray(sigma) ** 4)


def squared_wave_numbers(test: Measured, now: Prediction) -> FloatArray:
    """Return k^2 of each mode along each axis, where one end of the FRFs roves, (dim, n_modes) [1/m^2]."""
    ends = {"hit": (now.hit, now.hit_slopes), "seen": (now.seen, now.seen_slopes)}
    values, changes = ends[test.roving]
    slopes = changes[: test.points.shape[1]]
    return np.asarray(np.mean(slopes**2, axis=1) / np.maximum(np.mean(values**2, axis=0), 1e-300))
