"""Effects that are a factor on a property of the whole structure."""

from __future__ import annotations

from typing import ClassVar

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.mechanism import MASS_RATIO, STIFFNESS_OVER_MASS, STIFFNESS_RATIO, Size
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

RARER = 0.3
"""How often a section is wrong where a calibration may be as well: the two make one and the same change [-]."""


class FactorEffect(Effect):
    """A property of the whole structure that is off by a factor."""

    keeps_clamps = True
    factors: ClassVar[tuple[str, ...]]
    """Which factors of the model it multiplies."""
    low: ClassVar[float]
    high: ClassVar[float]
    why: ClassVar[str]
    powers: ClassVar[tuple[tuple[str, int], ...]]
    """Currencies of its size, each with the power in which the factor stands in it."""

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the relative changes that the factor makes."""
        return tuple(
            Size(quantity, float(values["factor"]) ** power - 1, "-") for quantity, power in self.powers
        )

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the factor."""
        return (Parameter("factor", "-", self.low, self.high, self.why, log=True),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the state with the factor applied."""
        factor: float = values["factor"]
        return State(factors=dict.fromkeys(self.factors, factor))


class Modulus(FactorEffect):
    """Modulus of elasticity off by a factor."""

    name = "E"
    channel = "stiffness"
    summary = "The modulus of elasticity differs from the model's by more than its tolerance."
    footprint = "All frequencies change by one factor; shapes and modal constants do not change."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("density", "thickness", "length", "clamp_rotation")
    separated_by = "absolute level (calibrated FRFs), a known added mass, or a measured density"
    factors = ("E",)
    powers = ((STIFFNESS_RATIO, 1), (STIFFNESS_OVER_MASS, 1))
    phrase = "the modulus of elasticity"
    low, high = 0.4, 2.5
    why = "wrong alloy or data sheet, not merely its scatter"


class Density(FactorEffect):
    """Mass density off by a factor."""

    name = "density"
    channel = "mass"
    summary = "The density (or a mass spread evenly) differs from the model's by more than its tolerance."
    footprint = "All frequencies change by one factor, modal constants by its square; shapes do not change."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("E", "thickness", "length", "fluid_added_mass", "local_mass")
    separated_by = "weigh the specimen; absolute level; a known added mass"
    factors = ("density",)
    powers = ((MASS_RATIO, 1),)
    phrase = "the density"
    low, high = 0.4, 2.5
    why = "wrong alloy, coating or paint"


class Thickness(FactorEffect):
    """Thickness off by a factor."""

    name = "thickness"
    channel = "stiffness"
    summary = "The thickness differs from the model's by more than its tolerance."
    footprint = "All frequencies change in proportion, modal constants in inverse proportion."
    equivalent_to = ("E", "density", "length")
    separated_by = "a caliper; absolute level; a known added mass"
    factors = ("thickness",)
    powers = (("relative thickness", 1), (STIFFNESS_OVER_MASS, 2))
    phrase = "the thickness"
    low, high = 0.6, 1.6
    why = "next standard gauge"


class SectionScale(FactorEffect):
    """Stiffness and mass off by the same factor, as by a wrong width."""

    name = "section_scale"
    channel = "stiffness"
    summary = "Stiffness and mass are off by the same factor, as if the width were wrong."
    footprint = "Modal constants change in inverse proportion; frequencies and shapes do not change."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("calibration_gain",)
    separated_by = "a caliper; a calibration of the measurement chain with a known mass"
    factors = ("section",)
    powers = (("relative section", 1),)
    phrase = "the scale of the section"
    low, high = 0.4, 2.5
    why = "wrong width or number of layers"

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need levels, which are all that it changes."""
        if predictor.measured.absolute:
            return None
        return Obstacle(
            Lack.DATA,
            "it changes only levels, and these data have no level; FRFs or mass-normalised shapes have one",
        )

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the one form there is, as likely against a wrong calibration as a caliper errs less often."""
        return (Variant(weight=RARER),)
