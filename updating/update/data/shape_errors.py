"""How well modal constants are known: errors of their own, of the poles, of places, and of calibration."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.prediction.misplaced import (
    best_levels,
    beyond_slopes,
    moved,
    per_place,
    squared_wave_numbers,
    stated_levels,
)
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
    left_out, places = _misplaced(test, at)
    sigma = np.sqrt(stated + extra * np.mean(test.constants**2, axis=0, keepdims=True) + left_out)
    sigma = np.broadcast_to(sigma, test.constants.shape).ravel()
    common = [*places, calibration * _all_alike(test, at)]
    if test.shared is not None:
        common.append(_flat(_smooth(test, at, test.shared)))
    return whitening(sigma, np.hstack(common))


def _all_alike(test: Measured, at: Prediction) -> FloatArray:
    """Return what an error common to all constants does to them, (n_frf * n_modes, 1) [1/kg].

    In proportion to predicted constants: in proportion to the measured ones, noise and all, such an error would
    make the noise smaller where it makes the constants smaller, and be found where there is none (Peelle's puzzle;
    Fröhner, Nucl. Sci. Eng. 126 (1997) 1-18).
    """
    signs = test.same_signs(at.constants)
    level = np.median(signs * best_levels(test.constants, at.constants))
    return np.asarray(level * (signs * at.constants).reshape(-1, 1))


def _smooth(test: Measured, at: Prediction, shared: FloatArray) -> FloatArray:
    """Return shared errors with their part along each measured shape put along the predicted one, for that reason."""
    shape = test.constants[..., None]
    along = np.sum(shape * shared, axis=0) / np.maximum(np.sum(shape**2, axis=0), 1e-300)
    predicted = at.constants * best_levels(shape[..., 0], at.constants)
    return np.asarray(shared + (predicted[..., None] - shape) * along)


def _flat(causes: FloatArray) -> FloatArray:
    rows, modes, count = causes.shape
    return causes.reshape(rows * modes, count)


def _misplaced(test: Measured, at: Prediction) -> tuple[FloatArray, list[FloatArray]]:
    """Return what hits and sensors out of place by a sigma do: a variance (1, n_modes), causes (n_frf * n_modes, k).

    A point's error is the same for all modes and all sensors: one cause for each direction, and for which of several
    nodes at the point is meant. What slopes leave out is a variance of its own for each place of what roves, and a
    factor on all constants of a mode for each fixed transducer. Its size is half the curvature times the square of the
    error, whose mean square is 3 sigma^4. A transducer that is far from a crest feels the curvature of the whole wave.
    """
    dim = test.points.shape[1]
    if len(at.seen_slopes) <= dim and (test.position_sigma <= 0 or not len(at.seen_slopes)):
        return np.zeros((1, test.constants.shape[1])), []
    level = stated_levels(test, at)
    by = moved(test, at, level, test.constants)
    doubts = np.ones((len(test.points), len(by.first)))
    doubts[:, :dim] = test.position_sigma
    causes = [
        per_place(np.where(test.hit < 0, test.seen, test.hit), doubts, by.first),
        per_place(test.seen, doubts, by.sensor),
    ]
    waves = np.sum(squared_wave_numbers(test, at), axis=0)
    left_out = beyond_slopes(test.position_sigma) * waves
    if test.absolute and not test.bare:
        roving, fixed = (at.hit, by.sensor) if test.fixed == "seen" else (at.seen, by.first)
        size = np.sqrt(left_out * (waves * by.constants**2 + np.sum(fixed**2, axis=0)))
        rank = np.unique(getattr(test, test.fixed), return_inverse=True)[1][:, None]
        row, mode = np.indices(size.shape)
        stretched = np.zeros((*size.shape, rank.max() + 1, size.shape[1]))
        stretched[row, mode, rank, mode] = np.copysign(size, roving)
        causes.append(stretched.reshape(size.size, -1))
    return (left_out * waves * np.mean(test.constants**2, axis=0))[None], causes
