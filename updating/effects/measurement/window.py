"""An exponential window that was left in the damping."""

from __future__ import annotations

from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor


class ExponentialWindow(Effect):
    """An exponential window was applied and not taken out of the damping."""

    name = "exponential_window"
    channel = "measurement"
    summary = "An exponential window is still in the damping: it adds one decay rate to every mode."
    footprint = (
        "Damping ratios rise in inverse proportion to frequency. The phase of the constants of low modes changes by "
        "twice that rise (accelerations). The noise after a hit decays. Shapes and stiffness do not change."
    )
    models = ("beam", "plate", "matrices")
    phrase = "an exponential window left in the data"
    equivalent_to = ("uniform_damping",)
    separated_by = (
        "phases of low modes, the noise of the hits; or the analyser's settings, a repeat with another window"
    )

    def damps(self, parameter: str = "") -> bool:
        """State that a decay is no frequency."""
        return True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the decay rate."""
        why = "windows end at 0.1 to 10 % of their start over records of 0.1 to 20 s"
        return (Parameter("decay", "1/s", 0.1, 70.0, why, log=True),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping."""
        return damping_obstacle(predictor)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the decay added to every mode."""
        return State(decay=values["decay"])
