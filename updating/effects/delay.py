"""A delay between the channels."""

from __future__ import annotations

from updating.effects.base import Effect, Parameter, Values
from updating.models.state import State
from updating.prediction import Predictor


class TimeDelay(Effect):
    """The responses lag the force: filters that differ, multiplexed channels, a network of recorders."""

    name = "time_delay"
    channel = "measurement"
    summary = "The response channels lag the force channel: every FRF turns in proportion to frequency."
    footprint = (
        "Modal constants turn by minus omega times the delay; their size, frequencies, damping unchanged."
    )
    models = ("beam", "plate", "matrices")
    separated_by = "swap the channels' inputs, or measure the same signal with both"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the delay."""
        longest = 0.5 / predictor.measured.frequency.max()
        why = "to half a period of the highest mode, either way"
        return (Parameter("delay", "s", -longest, longest, why),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of delays: a turn by half a circle looks like a reversed sign."""
        return tuple((u,) for u in (0.1, 0.3, 0.42, 0.58, 0.7, 0.9))

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need complex constants."""
        return None if predictor.measured.phase is not None else "the data carry no phase of the residues"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the delay."""
        return State(delay=values["delay"])
