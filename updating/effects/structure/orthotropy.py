"""A plate that is stiffer along one axis than along the other."""

from __future__ import annotations

from types import MappingProxyType

from updating.effects.base import Effect, Parameter, Values
from updating.models.state import State
from updating.models.terms import FieldTerm
from updating.prediction.predict import Predictor

SHARES = {("wyy", "wyy"): 1.0, ("wxx", "wyy"): 0.5, ("wxy", "wxy"): 0.5} | {
    ("ryy", "ryy"): 1.0,
    ("rxx", "ryy"): 0.5,
    ("rt", "rt"): 0.5,
    ("gx", "gx"): 0.5,
    ("gy", "gy"): 0.5,
}
"""Power of D_y / D_x in each term of the energy of a thin plate (Huber 1923) and of a thick one (G as the twist)."""


class Orthotropy(Effect):
    """Rolled sheet, laminates, ribs: the bending stiffness across differs from that along.

    ``ratio`` is D_y / D_x = E_y / E_x; D_x stays the model's. The coupling and the twisting stiffness follow the
    geometric mean (Huber 1923; Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, section 86):
    D_1 = nu D_x sqrt(ratio), 2 D_xy = (1 - nu) D_x sqrt(ratio).
    """

    name = "orthotropy"
    channel = "stiffness"
    summary = "The plate is stiffer along one axis than along the other (rolled sheet, laminate, ribs)."
    footprint = (
        "Modes that bend across shift, modes of torsion half as far, modes that bend along hardly at all."
    )
    models = ("plate",)
    separated_by = "strips cut along and across, or the data sheet of the sheet"
    elsewhere = MappingProxyType({"beam": "a beam bends along one axis only"})
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the ratio."""
        why = "from unidirectional laminates and ribbed sheet along x to the same along y; rolled sheet 0.9 to 1.1"
        return (Parameter("ratio", "-", 0.25, 4.0, why, log=True),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the plate with its terms across scaled."""
        reduced = predictor.reduced
        sums = reduced.sums
        change = 0.0 * sums[0]
        for term, whole in zip(reduced.structure.terms, sums, strict=True):
            assert isinstance(term, FieldTerm)
            power = SHARES.get((term.left, term.right), 0.0)
            if term.kind == "stiffness" and power:
                change = change + (values["ratio"] ** power - 1) * term.scale(predictor.base.factors) * whole
        return State(stiffness=(change,))
