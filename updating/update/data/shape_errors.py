"""How well modal constants are known: errors of their own, of the poles, of places, and of calibration."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured
from updating.update.data.whitening import Whitening, whitening

FINEST = 1e-4
"""No shape is measured better than this part of its r.m.s. [-]."""


def constant_errors(
    test: Measured, at: Prediction, calibration: float = 0.0, discrepancy: FloatArray | None = None
) -> Whitening:
    """Return the covariance of the measured constants, all FRFs of all modes in one vector (n_frf * n_modes).

    Parameters
    ----------
    test : Measured
        The test.
    at : Prediction
        The modes of a model near it, which say what a misplaced point does; constants and slopes of them.
    calibration : float
        Relative 1-sigma uncertainty of a level that all constants have in common [-].
    discrepancy : (n_modes,) array, optional
        A further error of each mode's shape over its r.m.s., once it is estimated; it stands in place of a guess [-].
    """
    extra = FINEST**2 + (0.0 if discrepancy is None else discrepancy**2)
    stated = 0.0 if test.guessed and discrepancy is not None else test.own_sigma**2
    left_out, stretched = _curved(test, at)
    sigma = np.sqrt(stated + extra * np.mean(test.constants**2, axis=0, keepdims=True) + left_out)
    sigma = np.broadcast_to(sigma, test.constants.shape).ravel()
    common = [_flat(_misplaced(test, at)), _flat(stretched), calibration * _all_alike(test, at)]
    if test.shared is not None:
        common.append(_flat(_smooth(test, at, test.shared)))
    return whitening(sigma, np.hstack(common))


def _level(test: Measured, at: Prediction) -> FloatArray:
    """Return the factor that brings each predicted mode nearest to the measured one, (n_modes,) [-]."""
    fit = np.sum(test.constants * at.constants, axis=0)
    return np.asarray(fit / np.maximum(np.sum(at.constants**2, axis=0), 1e-300))


def _all_alike(test: Measured, at: Prediction) -> FloatArray:
    """Return what an error common to all constants does to them, (n_frf * n_modes, 1) [1/kg].

    In proportion to predicted constants: in proportion to the measured ones, noise and all, such an error would
    make the noise smaller where it makes the constants smaller, and be found where there is none (Peelle's puzzle;
    Fröhner, Nucl. Sci. Eng. 126 (1997) 1-18).
    """
    signs = test.same_signs(at.constants)
    return np.asarray(np.median(signs * _level(test, at)) * (signs * at.constants).reshape(-1, 1))


def _smooth(test: Measured, at: Prediction, shared: FloatArray) -> FloatArray:
    """Return shared errors with their part along each measured shape put along the predicted one, for that reason."""
    shape = test.constants[..., None]
    along = np.sum(shape * shared, axis=0) / np.maximum(np.sum(shape**2, axis=0), 1e-300)
    return np.asarray(shared + ((at.constants * _level(test, at))[..., None] - shape) * along)


def _flat(causes: FloatArray) -> FloatArray:
    rows, modes, count = causes.shape
    return causes.reshape(rows * modes, count)


def _misplaced(test: Measured, at: Prediction) -> FloatArray:
    """Return what each point hit, and each sensor, out of place by a sigma does to the constants.

    A point's error is the same for all modes and all sensors: one cause for each direction, (n_frf, n_modes, k).
    """
    rows, modes = test.constants.shape
    if test.position_sigma <= 0 or not len(at.seen_slopes):
        return np.zeros((rows, modes, 0))
    bare = test.hit < 0
    hit = _by_point(_along(test, at), np.asarray(np.where(bare, test.seen, test.hit)), len(test.points))
    seen = _by_point(at.along_seen * ~bare[:, None], test.seen, len(test.points))
    return np.asarray(test.position_sigma * np.concatenate([hit, seen], axis=2) * _level(test, at)[:, None])


def _curved(test: Measured, at: Prediction) -> tuple[FloatArray, FloatArray]:
    """Return what slopes leave out of misplaced points' errors: a variance by hits, causes by sensors.

    Half the curvature times the square of the error, whose mean square is 3 sigma^4; the curvature is taken for that
    of waves with the mode's slopes, in every direction, whose crest a sensor may be far from. A sensor's error
    stretches all constants of a mode that it measures: (1, n_modes) [1/kg^2] and (n_frf, n_modes, n_modes *
    n_sensors) [1/kg].
    """
    rows, modes = test.constants.shape
    if test.position_sigma <= 0 or not len(at.seen_slopes):
        return np.zeros((1, modes)), np.zeros((rows, modes, 0))
    power = np.maximum(np.mean(at.constants**2, axis=0), 1e-300)
    wave = np.sum(np.mean(_along(test, at) ** 2, axis=1), axis=0) / power
    part = np.sqrt(0.75) * test.position_sigma**2 * wave
    crest = np.sqrt(1 + np.sum(np.mean(at.along_seen**2, axis=1), axis=0) / np.maximum(wave * power, 1e-300))
    stretch = at.constants * _level(test, at) * part * crest
    sensors = [test.seen == s for s in test.sensors]
    causes = [(stretch * own[:, None])[..., None] * np.eye(modes) for own in sensors]
    stretched = np.concatenate(causes, axis=2) if causes else np.zeros((rows, modes, 0))
    return np.asarray(part**2 * np.mean(test.constants**2, axis=0))[None], stretched


def _along(test: Measured, at: Prediction) -> FloatArray:
    """Return the constants' derivatives by the place of what roves, the sensor where no force is known."""
    return np.where((test.hit < 0)[:, None], at.along_seen, at.along)


def _by_point(slopes: FloatArray, point: IntArray, count: int) -> FloatArray:
    """Sort slopes (dim, n_frf, n_modes) by the point that moves, (n_frf, n_modes, dim * count)."""
    own = point[:, None] == np.arange(count)
    parts = slopes[..., None] * own[None, :, None, :]
    return np.concatenate(list(parts), axis=2)
