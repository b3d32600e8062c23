"""Correction of a model by a test of the same specimen before the effect was there.

The modes that the baseline measured take its frequencies and damping; their shapes stay the model's. What the
baseline did not reach keeps the stiffness that the measured modes have in the middle: one factor on all of it, so
that a clamp released later still finds a sound model. What is left is a matrix in modal coordinates, and every
effect acts on top of both, the coupling of modes included.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import EstimationError
from updating.matching import match
from updating.measured import Measured
from updating.models.state import State
from updating.prediction import Predictor


def correct(predictor: Predictor, baseline: Measured, order: IntArray) -> State:
    """Return what makes a model reproduce a baseline's frequencies and damping.

    Parameters
    ----------
    predictor : Predictor
        The model, bare, looked at from the points of the baseline.
    baseline : Measured
        The baseline's modes, each with a partner.
    order : (n_modes,) int array
        Rank of each mode's partner, for data without shapes.

    Returns
    -------
    State

    Raises
    ------
    EstimationError
        If two measured modes claim one of the model's.
    """
    prediction = predictor.predict(
        count=predictor.reduced.ranks[frozenset()] - predictor.reduced.structure.rigid_modes
    )
    partner = match(baseline, prediction, order)
    if len(set(partner.tolist())) < len(partner):
        raise EstimationError(
            "baseline: two measured modes belong to one of the model's; check the points and the axes"
        )
    ratio = baseline.frequency / prediction.frequency[partner]
    factor = float(np.median(ratio**2))
    _, mass = predictor.reduced.matrices(State())
    momenta = mass @ prediction.vectors
    nominal = (2 * np.pi * prediction.frequency[partner]) ** 2
    left = momenta[:, partner] * (nominal * (ratio**2 - factor))
    size = predictor.reduced.basis.shape[1]
    stiffness = (_padded(left @ momenta[:, partner].T, size),)
    finite = np.isfinite(baseline.damping)
    damping: tuple[FloatArray, ...] = ()
    if finite.any():
        ratios = np.full(len(prediction.frequency), float(np.median(baseline.damping[finite])))
        ratios[partner[finite]] = baseline.damping[finite]
        omega = 2 * np.pi * prediction.frequency * np.sqrt(factor)
        omega[partner] = 2 * np.pi * baseline.frequency
        damping = (_padded((momenta * (2 * ratios * omega)) @ momenta.T, size),)
    return State(factors={"E": factor}, stiffness=stiffness, damping=damping)


def _padded(matrix: FloatArray, size: int) -> FloatArray:
    """Extend a matrix of the clamped basis to the columns that releases add."""
    full = np.zeros((size, size))
    full[: len(matrix), : len(matrix)] = matrix
    return full
