"""The level of one point, or of one sensor among several."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.measurement.gain import GAIN
from updating.effects.measurement.points import channel_of, concerned, concerned_places, points_of
from updating.effects.measurement.shape_screening import PROMISING, ShapeScreening, screen
from updating.effects.obstacles import Obstacle, shape_obstacle
from updating.models.state import Role, State
from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured

OTHER_END = 0.5
"""Prior probability that it is one of several sensors (or forces) that stayed, each calibrated by itself [-]."""

GAINS = tuple(float(g) for g in np.geomspace(0.3, 3.3, 9) if abs(g - 1) > 0.01)
"""Gains at which a look at the shapes tries each point [-]: between two of them the misfit of a point that is off falls
to a tenth and less. Twice as many pass on the same points."""


class ChannelGain(Effect):
    """The level of some points, or of one of several sensors that stayed, is off by one factor."""

    name = "channel_gain"
    channel = "measurement"
    summary = (
        "The level of some points is off by one factor: a loose plug, a worn tip, another range or sensor, hits askew "
        "to the surface."
    )
    footprint = (
        "The constants of the points, or of a fixed sensor, change by one factor in all modes; all other constants, "
        "frequencies and damping do not change."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("position_error",)
    labels = ("points",)
    of_sensor = True
    repeats = True
    separated_by = "hit the points again; a calibration of each channel with a known free mass"
    phrase = "a channel of wrong level"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the gain."""
        return (GAIN,)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from no gain: the constants are linear in it, so that there is one maximum."""
        return ((0.5,),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need shapes at several points, or several sensors."""
        stayed = points_of(predictor.measured, _other(predictor.measured))
        return None if len(stayed) > 1 else shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the points whose level spoils the agreement of the shapes most, and each of several sensors."""
        test = predictor.measured
        role, stayed = test.roving, points_of(test, _other(test))
        points, several = points_of(test, role), len(stayed) > 1
        share = (1.0 - OTHER_END * several) / max(len(points), 1)
        found = screen(predictor)
        worst = np.argsort([_misfit(found, (role, p)) for p in points])[:PROMISING]
        moved = [Variant({"points": (test.nodes[points[i]],)}, share) for i in worst]
        each = [Variant({"channel": channel_of(test, p)}, OTHER_END / len(stayed)) for p in stayed]
        return (*moved, *(each if several else ()))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the points of the end that roved with their level off, or the sensor that stayed."""
        gain = float(values["gain"])
        return State(point_gains=dict.fromkeys(concerned(predictor.measured, values), gain))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points, or where the sensor sits."""
        return concerned_places(predictor.measured, values)

    def sentence(self, values: Values) -> str:
        """State whether it is a fixed sensor or points of the end that roved."""
        if "channel" not in values:
            return self.summary
        sensor = values["channel"]
        return f"The calibration of the sensor {sensor} is off: its FRFs are too large or too small by one factor."


def _other(test: Measured) -> str:
    return "seen" if test.roving == "hit" else "hit"


def _misfit(found: ShapeScreening, point: Role) -> float:
    """Return the misfit of the shapes with the best gain at one point [-]."""
    return min(found.misfit({point: gain}) for gain in GAINS)
