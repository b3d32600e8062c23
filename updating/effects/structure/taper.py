"""A thickness that changes along the structure, from one end to the other."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType

from scipy.special import binom

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.effects.base import Effect, EitherSign, Parameter, Values
from updating.models.base import Term
from updating.models.state import State
from updating.prediction.predict import Predictor

SLOPES = (0.01, 0.8)
"""Smallest and largest size of the change over the length, relative to the thickness in the middle [-]: what a caliper
misses, and a wedge that is over twice as thick at one end as at the other."""

CUBE = 3
"""Highest power of the thickness in either matrix: of bending, and of the inertia of turning sections."""

NOTHING_LEFT = 2.0
"""Size of the slope at which one end has no thickness [-]."""


class Taper(Effect):
    """The thickness changes in proportion to the place along x, and stays what it is in the middle.

    With s the slope and m the place in the middle from -1/2 to 1/2, a term that goes with the p-th power of the
    thickness has (1 + s m)^p: a polynomial in s, whose matrices are those of the nominal model under powers of m.
    """

    name = "taper"
    channel = "stiffness"
    summary = "The thickness changes along the structure (a wedge, wear, a casting's draft), and the model's does not."
    footprint = (
        "With the clamp at the thicker end the lowest frequency rises most, the next less, and their shapes change. On "
        "a free structure frequencies hardly change, and shapes lean to the thinner end."
    )
    separated_by = "a caliper at both ends"
    elsewhere = MappingProxyType({"matrices": "imported matrices have no thickness"})
    phrase = "a taper"
    fidelity = 0.02  # none of a straight wedge; a caliper's profile of a worn or rolled one is not straight

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the slope."""
        least, most = SLOPES
        why = "from the error of a caliper to a wedge over twice as thick at one end; of either sign, uniform in log"
        return (EitherSign("slope", "-", -most, most, why, signed=True, least=least),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a slight slope and a steep one of either sign."""
        return ((0.12,), (0.3,), (0.7,), (0.88,))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the wedge.

        Raises
        ------
        StudyError
            If nothing is left of one end.
        """
        slope = values["slope"]
        if not abs(slope) < NOTHING_LEFT:
            raise StudyError(
                f"taper: slope = {slope:g} leaves no thickness at one end; give a slope below {NOTHING_LEFT:g} in size"
            )
        stiffness, mass = (
            [slope**order * self._unit(predictor, kind, order) for order in range(1, CUBE + 1)]
            for kind in ("stiffness", "mass")
        )
        return State(stiffness=tuple(stiffness), mass=tuple(mass))

    def _unit(self, predictor: Predictor, kind: str, order: int) -> FloatArray:
        """Return what a matrix gains with a power of the slope, (r, r) [SI]."""

        def build() -> FloatArray:
            reduced = predictor.reduced
            middled = reduced.fields.points[:, 0] / predictor.spec.length - 0.5
            share = partial(_coefficient, order=order)
            return reduced.weighted(kind, middled**order, predictor.base.factors, share=share)

        return predictor.once(f"taper of {kind}, {order}", build)


def _coefficient(term: Term, *, order: int) -> float:
    """Return the binomial coefficient of a term's power in the thickness [-]."""
    return float(binom(term.powers.get("thickness", 0.0), order))
