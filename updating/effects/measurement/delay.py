"""A delay between the channels."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

PERIODS = 2.0
"""The longest delay, in periods of the highest mode: some five samples at 2.56 samples a period [-]."""

LOOKED_AT = 801
"""Delays at which the phases are examined, and..."""

STARTS = 4
"""...how many of them a search starts from."""

ROUGHLY = 0.03
"""How closely the phases are examined: what filters and complex modes turn them by [rad]."""


class TimeDelay(Effect):
    """The responses lag the force: filters that differ, multiplexed channels, a network of recorders."""

    phrase = "a time delay between the channels"
    name = "time_delay"
    channel = "measurement"
    summary = "The response channels lag the force channel: every FRF turns in proportion to frequency."
    footprint = (
        "The phase of the modal constants changes by minus omega times the delay; nothing else changes."
    )
    models = ("beam", "plate", "matrices")
    separated_by = "swap the channels' inputs, or measure the same signal with both"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the delay."""
        longest = PERIODS / predictor.measured.frequency.max()
        why = f"up to {PERIODS:g} periods of the highest mode, about five samples, of either sign"
        return (Parameter("delay", "s", -longest, longest, why),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from the delays at which the phases of all modes agree best.

        A phase is known to within half a turn, since signs may be reversed, so that many delays explain one mode.
        """
        test = predictor.measured
        if test.phase is None or test.phase_sigma is None:
            return ((0.5,),)
        quantiles = np.linspace(0.0, 1.0, LOOKED_AT)
        (delay,) = self.parameters(predictor)
        lag = 2 * np.pi * (delay.low + (delay.high - delay.low) * quantiles)[:, None, None] * test.frequency
        left = np.sin(test.phase + lag) ** 2 / (test.phase_sigma**2 + ROUGHLY**2)
        misfit = np.pad(left.sum(axis=(1, 2)), 1, constant_values=np.inf)
        dips = np.flatnonzero((misfit[1:-1] < misfit[:-2]) & (misfit[1:-1] <= misfit[2:]))
        best = dips[np.argsort(misfit[1:-1][dips])[:STARTS]]
        return tuple((float(quantiles[i]),) for i in best)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need complex constants."""
        if predictor.measured.phase is not None:
            return None
        return Obstacle(Lack.DATA, "the data have no phase of the residues")

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the delay."""
        return State(delay=values["delay"])
