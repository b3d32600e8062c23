"""The calibration of the measurement chain."""

from __future__ import annotations

from updating.effects.base import Effect, Parameter, Twin, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

GAIN = Parameter(
    "gain",
    "-",
    0.08,
    12.5,
    "wrong sensitivity or charge range (a decade), g taken for m/s^2 (9.81), lbf for N (4.45)",
    log=True,
)
"""Gain of a measuring chain, or of one channel of it."""


class CalibrationGain(Effect):
    """The absolute level of all FRFs is off by one factor; that of single channels is ``channel_gain``."""

    name = "calibration_gain"
    channel = "measurement"
    summary = (
        "The calibration of the measurement chain is off: every FRF is too large or too small by one factor."
    )
    footprint = "Modal constants change by one factor; frequencies, damping and shapes do not."
    models = ("beam", "plate", "matrices")
    phrase = "a wrong calibration"
    competes_with = "calibration"
    equivalent_to = ("section_scale",)
    twin = Twin(
        "section_scale",
        "both scale every FRF and nothing else",
        "calibrate the chain, or weigh and measure the specimen",
    )
    separated_by = "a calibration with a known free mass"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the gain."""
        return (GAIN,)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need absolute level."""
        if predictor.measured.absolute:
            return None
        return Obstacle(Lack.DATA, "the data have no absolute level")

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the gain."""
        return State(gain=values["gain"])
