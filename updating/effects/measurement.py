"""Effects of the measurement itself: the structure is as modelled, the data are not as believed."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values
from updating.models.state import State
from updating.prediction import Predictor


class ExponentialWindow(Effect):
    """An exponential window was applied and not taken out of the damping."""

    name = "exponential_window"
    channel = "measurement"
    summary = "An exponential window is still in the damping: it adds one decay rate to every mode."
    footprint = "Damping ratios rise in inverse proportion to frequency; nothing else changes."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("uniform_damping",)
    separated_by = "the analyser's settings, or a repeat with another window or a longer record"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the decay rate."""
        why = "windows end at 0.1 to 10 % of their start over records of 0.1 to 20 s"
        return (Parameter("decay", "1/s", 0.1, 70.0, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need an expectation of the damping."""
        if not np.isfinite(predictor.measured.damping).any():
            return "no damping was measured"
        return None if predictor.expects_damping else "neither model nor baseline says what damping to expect"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the decay added to every mode."""
        return State(decay=values["decay"])


class CalibrationGain(Effect):
    """The absolute level of all FRFs is off by one factor."""

    name = "calibration_gain"
    channel = "measurement"
    summary = (
        "The calibration of the measurement chain is off: every FRF is too large or too small by one factor."
    )
    footprint = "Modal constants by one factor; frequencies, damping and shapes unchanged."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("section_scale",)
    separated_by = "a calibration with a known free mass"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the gain."""
        why = "wrong sensitivity, charge range, or hammer tip factor"
        return (Parameter("gain", "-", 0.4, 2.5, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need absolute level."""
        return None if predictor.measured.absolute else "the data carry no absolute level"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the gain."""
        return State(gain=values["gain"])
