"""Shear deformation and rotary inertia that slender theories leave out."""

from types import MappingProxyType

from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.spec import FULLER
from updating.models.state import State
from updating.prediction.predict import Predictor


class Shear(Effect):
    """Timoshenko's beam in place of Euler and Bernoulli's, Mindlin's plate in place of Kirchhoff's.

    Timoshenko (1921) with the coefficient of Cowper (1966); Mindlin (1951) with that of Reissner (1945).
    """

    name = "shear"
    channel = "stiffness"
    summary = "The theory of the model leaves out shear deformation and rotary inertia."
    footprint = (
        "Frequencies fall in proportion to the square of thickness over wavelength. On plates with free edges, modes "
        "of torsion fall most, in proportion to the thickness."
    )
    models = ("beam", "plate")
    separated_by = 'theory = "timoshenko" (beams) or "mindlin" (plates); nothing has to be measured'
    phrase = "shear and rotary inertia"
    elsewhere = MappingProxyType(
        {"matrices": "whether shear is included is fixed by the elements of the matrices"}
    )
    fuller = True
    fidelity = 0.01

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing: the section fixes everything."""
        return ()

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need a theory that lacks it."""
        there = predictor.spec.fuller is None
        return Obstacle(Lack.MODEL, "the model has it already") if there else None

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the same structure under the fuller theory."""
        return State(theory=FULLER[predictor.spec.kind])
