"""The calibration of the measurement chain."""

from __future__ import annotations

from updating.effects.base import Effect, Parameter, Twin, Values, Variant
from updating.effects.measurement.points import channel_of, channel_point
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.test_data.chain import fixed_sensors


class CalibrationGain(Effect):
    """The absolute level of all FRFs, or of those of one of several sensors, is off by one factor."""

    name = "calibration_gain"
    channel = "measurement"
    summary = (
        "The calibration of the measurement chain is off: every FRF is too large or too small by one factor."
    )
    footprint = "Modal constants by one factor; frequencies, damping and shapes unchanged."
    models = ("beam", "plate", "matrices")
    phrase = "a wrong calibration"
    competes_with = "calibration"
    equivalent_to = ("section_scale",)
    twin = Twin(
        "section_scale",
        "both scale every FRF and nothing else",
        "calibrate the chain, or weigh and measure the specimen",
    )
    of_sensor = True
    separated_by = "a calibration with a known free mass"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the gain."""
        why = "wrong sensitivity or charge range (a decade), g taken for m/s^2 (9.81), lbf for N (4.45)"
        return (Parameter("gain", "-", 0.08, 12.5, why, log=True),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need absolute level."""
        if predictor.measured.absolute:
            return None
        return Obstacle(Lack.DATA, "the data carry no absolute level")

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the whole chain, and each sensor where there are several."""
        sensors = fixed_sensors(predictor.measured)
        if len(sensors) < 2:
            return (Variant(),)
        names = [channel_of(predictor.measured, s) for s in sensors.tolist()]
        each = tuple(Variant({"channel": name}, 0.5 / len(sensors)) for name in names)
        return (Variant(weight=0.5), *each)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the gain."""
        if "channel" not in values:
            return State(gain=values["gain"])
        return State(point_gains={channel_point(predictor.measured, values["channel"]): values["gain"]})

    def sentence(self, values: Values) -> str:
        """Say which sensor it is."""
        if "channel" not in values:
            return self.summary
        sensor = values["channel"]
        return f"The calibration of the sensor {sensor} is off: its FRFs are too large or too small by one factor."
