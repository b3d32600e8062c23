"""The identified damping ratios in a model, as paper A does it for its FRFs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.spec import Damping
from updating.prediction.matching import Paired, pair_modes
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured

UNKNOWN_DAMPING = 0.005
"""Damping ratio of modes of which neither test nor model gives any [-]."""


def partners(paired: Paired, prediction: Prediction) -> IntArray:
    """Return the number of the model's mode that belongs to each mode of a pairing."""
    return paired.order if paired.measured.has_shapes else np.argsort(prediction.frequency)[paired.order]


def identified_ratios(paired: Paired, prediction: Prediction) -> FloatArray | None:
    """Return a damping ratio for every mode of a model, and a last one for all above [-].

    Paired modes have what was measured, the others the median of these; None where no damping was measured.
    """
    found = paired.measured.damping
    known = np.isfinite(found) & (found > 0)
    if not known.any():
        return None
    ratios = np.full(len(prediction.frequency) + 1, np.median(found[known]))
    ratios[partners(paired, prediction)[known]] = found[known]
    return ratios


def with_ratios(predictor: Predictor, ratios: FloatArray) -> Predictor:
    """Return the predictor with damping ratios by mode in place of all that its model expects.

    Parameters
    ----------
    predictor : Predictor
        The model, on whose basis the answer stays.
    ratios : (n,) array
        Damping ratios from the lowest elastic mode, the last for all above [-].
    """
    own = [r for r in predictor.spec.regions if any(v is not None for v in (r.alpha, r.beta, r.loss_factor))]
    regions = tuple(replace(r, alpha=None, beta=None, loss_factor=None) for r in predictor.spec.regions)
    damping = Damping(ratios=tuple(float(r) for r in ratios))
    other = predictor.of(replace(predictor.spec, damping=damping, regions=regions))
    return other if own else other.on(predictor.reduced)  # the basis includes only the regions' damping


def with_identified_damping(predictor: Predictor, measured: Measured | None = None) -> Predictor:
    """Return the model with the damping ratios of the measured modes that pair with its own.

    Parameters
    ----------
    predictor : Predictor
        The model, updated or not.
    measured : Measured, optional
        The test; left out, the predictor's own.

    Raises
    ------
    StudyError
        If no damping was measured.
    EstimationError
        If no measured mode has a partner.
    """
    test = predictor.measured if measured is None else measured
    prediction = predictor.for_test(test).predict()
    ratios = identified_ratios(pair_modes(test, prediction), prediction)
    if ratios is None:
        raise StudyError(f"{test.title or 'test'}: no damping was measured to put into the model")
    return with_ratios(predictor, ratios)
