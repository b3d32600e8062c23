"""Which of a model's predicted modes belongs to each measured mode, fast enough for every evaluation."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured

FREQUENCY_WEIGHT = 0.5
"""How much a frequency ratio of e counts against a MAC of zero."""


def mac_of_constants(
    measured: Measured, prediction: Prediction, trusted: BoolArray | None = None
) -> FloatArray:
    """Return the MAC between measured and predicted modal constants, (n_measured, n_predicted) [-].

    Parameters
    ----------
    measured, prediction
        Test and model.
    trusted : (n_frf,) bool array, optional
        Rows to use; left out, all.
    """
    rows = slice(None) if trusted is None else trusted
    a, b = measured.constants[rows], prediction.constants[rows]
    power = np.outer(np.sum(a**2, axis=0), np.sum(b**2, axis=0))
    return np.asarray((a.T @ b) ** 2 / np.maximum(power, 1e-300))


def frac_of_constants(measured: Measured, prediction: Prediction) -> FloatArray:
    """Return FRAC of the constants over paired modes, per FRF; none where the level of each mode is its own.

    Parameters
    ----------
    measured, prediction : Measured, Prediction
        Test and model, of the same modes in the same order.

    Returns
    -------
    (n_frf,) or (0,) array
        Between 0 and 1 [-].
    """
    if not measured.absolute:
        return np.zeros(0)
    a, b = measured.constants, prediction.constants * measured.same_signs(prediction.constants)
    power = np.sum(a**2, axis=1) * np.sum(b**2, axis=1)
    return np.asarray(np.sum(a * b, axis=1) ** 2 / np.maximum(power, 1e-300))


AS_STATED = 1e3
"""What a stated pair gains over any other: more than all other pairs of any test cost together [-]."""


def match(
    measured: Measured, prediction: Prediction, order: IntArray, trusted: BoolArray | None = None
) -> IntArray:
    """Assign a predicted mode to every measured mode.

    Parameters
    ----------
    measured : Measured
        The test.
    prediction : Prediction
        The model's modes.
    order : (n_measured,) int array
        Rank of the model mode that belongs to each measured one where shapes cannot tell: the i-th entry
        counts model modes from the lowest.
    trusted : (n_frf,) bool array, optional
        Rows whose shapes are compared; left out, those that the test trusts.

    Returns
    -------
    (n_measured,) int array
        Index of the predicted mode of each measured mode.
    """
    if not measured.has_shapes:
        return np.asarray(np.argsort(prediction.frequency)[order])
    trusted = measured.trusted if trusted is None else trusted
    ratio = np.abs(np.log(measured.frequency[:, None] / prediction.frequency[None, :]))
    ratio = np.nan_to_num(ratio, nan=3.0)
    alike = np.nan_to_num(
        mac_of_constants(measured, prediction, trusted)
    )  # what has lost its mass is like nothing
    cost = 1 - alike + FREQUENCY_WEIGHT * np.minimum(ratio, 3.0)
    if measured.partners is not None:
        columns = _stated(measured, prediction)
        rows = np.flatnonzero((columns >= 0) & (columns < cost.shape[1]))
        cost[rows, columns[rows]] = -AS_STATED
    return np.asarray(linear_sum_assignment(cost)[1])


def _stated(measured: Measured, prediction: Prediction) -> IntArray:
    """Return the predicted mode that each measured one is stated to be (n_measured,), negative where none is.

    Pairs are stated of the nominal model; in one that has changed its modes are known again by their shapes, since two
    may have changed places.
    """
    assert measured.partners is not None
    if measured.partner_constants is None:
        return measured.partners
    own, now = measured.partner_constants, prediction.constants
    power = np.sum(own**2, axis=0)[:, None] * np.sum(now**2, axis=0)
    alike = np.nan_to_num((own.T @ now) ** 2 / np.maximum(power, 1e-300))
    return np.where(measured.partners < 0, measured.partners, alike.argmax(axis=1))
