"""What damps a simulated model: the model itself, else the test, else a usual figure."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import EstimationError
from modalkit.study.read import Study
from modalkit.workflow.case import Session
from updating import Measured, Predictor, Spec
from updating.nominal import predictor_of
from updating.prediction.matching import pair_modes
from updating.simulation import UNKNOWN_DAMPING, identified_ratios, with_ratios


def damped_spec(study: Study, session: Session | None) -> tuple[Spec, tuple[str, ...]]:
    """Return the study's model with some damping, and where it is from if not from the model itself."""
    spec = study.spec()
    if session is None:
        nothing = np.zeros(0)
        blank = Measured(
            frequency=nothing, frequency_sigma=nothing, damping=nothing, damping_sigma=nothing,
            points=np.zeros((0, spec.dim)), nodes=(), seen=np.zeros(0, int), hit=np.zeros(0, int),
            constants=np.zeros((0, 0)), constants_sigma=np.zeros((0, 0)), absolute=False,
        )  # fmt: skip
        predictor = Predictor(spec, blank)
    else:
        predictor = predictor_of(session.case)
    if predictor.expects_damping:
        return spec, ()
    ratios = None if session is None else _ratios(predictor)
    if ratios is not None:
        return with_ratios(Predictor(spec, predictor.measured), ratios).spec, (
            "damping: the identified ratios, their median where no mode was identified",
        )
    note = f"damping: neither model nor test states any; {100 * UNKNOWN_DAMPING:g} % for every mode"
    return with_ratios(Predictor(spec, predictor.measured), np.array([UNKNOWN_DAMPING])).spec, (note,)


def _ratios(predictor: Predictor) -> FloatArray | None:
    prediction = predictor.predict()
    try:
        return identified_ratios(pair_modes(predictor.measured, prediction), prediction)
    except EstimationError:  # a test unlike the model still defines how to hit it
        return None
