"""A structure that changes while the hammer or the sensor goes from point to point."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, EitherSign, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.thresholds import UNREMARKABLE_TREND


class Drift(Effect):
    """All frequencies change by one factor while a test goes on, in proportion to the place in measuring order.

    The frequencies of the state are those in the middle of the test, which a fit to all FRFs finds: a drift moves none
    of them. Were the specimen nominal at the first point rather than then, E would be off by the rate.
    """

    name = "drift"
    channel = "measurement"
    summary = "Frequencies drift during the test, from point to point: it got warmer or colder, or a support settled."
    footprint = (
        "All frequencies change by one factor, in proportion to the position in the measuring order; the frequencies "
        "of the whole test are those at its middle."
    )
    models = ("beam", "plate", "matrices")
    phrase = "a drift during the test"
    separated_by = "hit the first point again at the end, and note the temperature"
    fidelity = 0.05  # modes with other shares of clamps and joints drift by other factors

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the rate."""
        why = "from 2 K on metals, which every test has, to 15 K on plastics; of either sign, uniform in its log"
        # identification believes shifts of 2 % to either side of the middle; plastics are ten times as soft to
        # temperature as metals. Doubled: faint drifts need a little more evidence
        bounds = -0.04, 0.04
        return (EitherSign("rate", "-", *bounds, why, signed=True, least=UNREMARKABLE_TREND),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from what the modes show."""
        test = predictor.measured
        if test.trend is None or test.trend_sigma is None:
            return ((0.5,),)
        known = np.isfinite(test.trend)
        (rate,) = self.parameters(predictor)
        weight = test.trend_sigma[known] ** -2.0
        return ((rate.coordinate(float(weight @ test.trend[known] / weight.sum())),),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need FRFs that were measured one after the other."""
        test = predictor.measured
        if test.trend is not None and np.isfinite(test.trend).any():
            return None
        what = (
            "the measuring order of at least three points is unknown: FRFs or hits of a roving test "
            "are needed"
        )
        return Obstacle(Lack.DATA, what)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the drift."""
        return State(drift=values["rate"])
