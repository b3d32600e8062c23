"""Shear deformation and rotary inertia that Euler-Bernoulli theory leaves out."""

from types import MappingProxyType
from typing import ClassVar

from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.spec import Theory
from updating.models.state import State
from updating.prediction.predict import Predictor


class Shear(Effect):
    """Timoshenko's beam in place of Euler and Bernoulli's (Timoshenko 1921; coefficient of Cowper 1966)."""

    name = "shear"
    channel = "stiffness"
    summary = "The beam theory leaves out shear deformation and rotary inertia."
    footprint = "Frequencies fall, in proportion to the square of the thickness over the wavelength."
    models = ("beam",)
    separated_by = "a Timoshenko model; nothing has to be measured"
    phrase = "shear and rotary inertia"
    elsewhere = MappingProxyType(
        {"plate": "plates are modelled as thin; shear in plates is not in the library"}
    )
    theory: ClassVar[Theory] = "timoshenko"
    fidelity = 0.01

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing: the section fixes everything."""
        return ()

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a beam whose theory lacks it."""
        there = predictor.spec.theory == self.theory
        return Obstacle(Lack.MODEL, "the model has it already") if there else None

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the same structure as a Timoshenko beam."""
        return State(theory=self.theory)
