"""Correction of a model by a test of the same specimen before the effect was there.

The modes that the baseline measured take its frequencies and damping; their shapes stay the model's. What the
baseline did not reach keeps the stiffness that the measured modes have in the middle: one factor on all of it, so
that a clamp released later still finds a sound model. Where levels are calibrated, modal masses follow them; where
they are not, the level is that of the measurement chain. What is left is a matrix in modal coordinates, and every
effect acts on top of both, the coupling of modes included.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import EstimationError
from updating.models.damping import WHOLE
from updating.models.state import State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured

COARSE = 0.2
"""A calibration worse than this does not determine modal masses [-]."""

LEAST_LEVEL = 0.1
"""Modes whose predicted constants are smaller than this share of the strongest mode's say where the sensor sits beside
a node, and nothing of modal masses [-]. Of equally heavy modes constants differ by two or three, near a node by any
number. Doubled: a mode near a node is left out sooner; nothing, where four others are left."""


def correct(predictor: Predictor, baseline: Measured, order: IntArray) -> State:
    """Return what makes a model reproduce a baseline's frequencies and damping.

    Parameters
    ----------
    predictor : Predictor
        The model as it was in the baseline, observed from its points.
    baseline : Measured
        The baseline's modes, each with a partner.
    order : (n_modes,) int array
        Rank of each mode's partner, for data without shapes.

    Returns
    -------
    State
        What comes on top of that model.

    Raises
    ------
    EstimationError
        If two measured modes claim one of the model's.
    """
    everything = predictor.reduced.ranks[frozenset()] - predictor.reduced.structure.rigid_modes
    plain = predictor.predict(count=everything)
    partner = match(baseline, plain, order)
    if len(set(partner.tolist())) < len(partner):
        raise EstimationError(
            "baseline: two measured modes belong to one of the model's; check the points and the axes"
        )
    heavier, _ = modal_mass(baseline, plain.constants[:, partner])
    factor = float(np.median((baseline.frequency / plain.frequency[partner]) ** 2))
    scaled = State(factors={"E": factor, "section": heavier})
    prediction = predictor.predict(scaled, count=everything)
    partner = match(baseline, prediction, order)
    _, mass = _matrices(predictor, scaled, len(prediction.vectors))
    momenta = mass @ prediction.vectors
    wanted, there = (2 * np.pi * baseline.frequency) ** 2, (2 * np.pi * prediction.frequency[partner]) ** 2
    size = predictor.reduced.basis.shape[1]
    left = (momenta[:, partner] * (wanted - there)) @ momenta[:, partner].T
    gain = 1.0
    if baseline.absolute and baseline.calibration > COARSE:
        gain = 1 / float(np.median(_level(baseline, prediction.constants[:, partner])))
    found = State(factors=scaled.factors, stiffness=(_padded(left, size),), gain=gain)
    finite = np.isfinite(baseline.damping)
    if not finite.any():
        return found
    dampers, damping = _damping(predictor, scaled, momenta[:, partner[finite]], baseline.modes(finite))
    return replace(found, dampers=dampers, damping=(damping,))


def in_one_chain(test: Measured, baseline: Measured) -> Measured:
    """Return a test with what is in doubt of its level once a baseline was measured through the same chain.

    Sensor, amplifiers and hammer are taken to be those of the baseline where the same uncertainty is stated of both
    levels. What their calibrations are off by is then in both tests, and :func:`correct` has found it. What is left is
    how far a level repeats: no worse than a calibrated one is known.

    Parameters
    ----------
    test, baseline : Measured
        Two tests of one specimen.
    """
    same = test.absolute and baseline.absolute and not (test.bare or baseline.bare)
    if not same or test.calibration != baseline.calibration:
        return test
    return replace(test, calibration=min(test.calibration, Measured.calibration))


def _damping(
    predictor: Predictor, scaled: State, momenta: FloatArray, baseline: Measured
) -> tuple[dict[tuple[int, str], float], FloatArray]:
    """Return coefficients that come nearest to the measured ratios, and the viscous matrix that they lack of them.

    The coefficients damp what was not measured as well, the motion of a clamp let loose included, and go with mass
    and stiffness where an effect changes these.
    """
    reduced, count = predictor.reduced, len(momenta)
    stiffness, mass = _matrices(predictor, scaled, count)
    omega = 2 * np.pi * baseline.frequency
    shares = np.stack([0.5 / omega, 0.5 * omega], axis=1) / baseline.damping[:, None]
    alpha, beta = nnls(shares * [1.0, 1 / omega.max()], np.ones(len(omega)))[0] * [1.0, 1 / omega.max()]
    modes = np.linalg.solve(mass, momenta)
    there = sum(
        (matrix[:count, :count] for matrix in predictor.base.damping), alpha * mass + beta * stiffness
    )
    now = np.sum(modes * (there @ modes), axis=0)
    lacking = (momenta * (2 * baseline.damping * omega - now)) @ momenta.T
    dampers = {(WHOLE, "alpha"): float(alpha), (WHOLE, "beta"): float(beta), (WHOLE, "loss_factor"): 0.0}
    return dampers, _padded(lacking, reduced.basis.shape[1])


def _matrices(predictor: Predictor, state: State, count: int) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of a state on the first columns of its basis, (count, count): no absorbers' [SI]."""
    stiffness, mass = predictor.reduced.matrices(predictor.base.plus(state))
    return stiffness[:count, :count], mass[:count, :count]


def modal_mass(baseline: Measured, predicted: FloatArray) -> tuple[float, float]:
    """Return by what factor the specimen is heavier than its model, and the doubt in its logarithm.

    A model that is too stiff for a test may as well be too light: frequencies do not show it. The level of calibrated
    FRFs can, since modal constants are inverse modal masses.

    Parameters
    ----------
    baseline : Measured
        The baseline's modes.
    predicted : (n_frf, n_modes) array
        The model's constants for them [1/kg].
    """
    if not baseline.absolute or baseline.calibration > COARSE:
        return 1.0, np.inf
    level = _level(baseline, predicted)
    heavier = float(np.median(level))
    return heavier, float(np.hypot(baseline.calibration, np.std(level) / heavier / np.sqrt(len(level))))


def _level(baseline: Measured, predicted: FloatArray) -> FloatArray:
    """Return the predicted level over the measured one, as that of FRFs, of each mode far enough from a node [-]."""
    size = np.linalg.norm(predicted, axis=0)
    seen = size > LEAST_LEVEL * size.max()
    level = size[seen] / np.linalg.norm(baseline.constants[:, seen], axis=0)
    return np.asarray(level**2 if baseline.bare else level)


def doubt_in_mass(predictor: Predictor, baseline: Measured, order: IntArray) -> float:
    """Return the doubt in the logarithm of the modal masses that a baseline leaves [-].

    Where levels do not decide, half of the correction of the frequencies may have been due to mass.
    """
    plain = predictor.predict(at_least=int(order.max()) + 3)
    partner = match(baseline, plain, order)
    correction = float(np.median(np.log(baseline.frequency / plain.frequency[partner])))
    return float(min(modal_mass(baseline, plain.constants[:, partner])[1], abs(correction)))


def _padded(matrix: FloatArray, size: int) -> FloatArray:
    """Extend a matrix of the clamped basis to the columns that releases add."""
    full = np.zeros((size, size))
    full[: len(matrix), : len(matrix)] = matrix
    return full
