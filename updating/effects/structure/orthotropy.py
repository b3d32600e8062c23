"""A plate that is stiffer along one axis than along the other, with a shear and a Poisson's ratio of its own."""

from __future__ import annotations

import math
from types import MappingProxyType

from updating.effects.base import Effect, Parameter, Values
from updating.models.state import State
from updating.models.terms import ACROSS, COUPLING, TWIST
from updating.prediction.predict import Predictor

HUBER = 1.0
"""Shear modulus and coupling where none is stated, over those of Huber [-]."""

STARTS_ALONG = 12
"""Starts of the search along the ratio, a factor of 1.7 apart: at twice that modes change places in between."""

FIRMEST = 0.95
"""Most that the coupling may be of what makes bending cost nothing, D_1 = sqrt(D_x D_y) [-]."""


class Orthotropy(Effect):
    """Rolled sheet, wood, laminates, ribs: stiffness across, and in twist, differs from that along.

    ``ratio`` is D_y / D_x = E_y / E_x; D_x stays the model's. Coupling and twist follow the geometric mean but for a
    factor of their own: D_1 = nu D_x sqrt(ratio) coupling, 2 D_xy = (1 - nu) D_x sqrt(ratio) shear_ratio (Huber 1923
    with both 1; Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, section 86; of independent constants
    Lekhnitskii, Anisotropic Plates, 1968). A sheet whose Poisson's ratio along is the model's has the coupling
    sqrt(ratio).
    """

    name = "orthotropy"
    channel = "stiffness"
    summary = "The plate's stiffness across, or in twist, differs from that along (rolled sheet, wood, laminate, ribs)."
    footprint = (
        "The ratio shifts modes that bend across, modes of torsion half as far, and modes that bend along hardly at "
        "all. The ratio of shear shifts modes of torsion only, the coupling modes that bend both ways."
    )
    models = ("plate",)
    separated_by = "strips cut along, across and at 45 degrees, or the data sheet of the sheet"
    elsewhere = MappingProxyType({"beam": "a beam bends along one axis only"})
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the ratio of stiffness, and those of shear and of Poisson's ratio to Huber's."""
        why = (
            "from softwood and laminates of strong fibres along x (1/10 to 1/25) to the same along y; ribbed sheet "
            "0.25 to 4, rolled sheet 0.9 to 1.1"
        )
        shear = (
            "from woven carbon (0.15), open ribs and unidirectional laminates (0.3 to 0.5), wood (0.5 to 0.7) over "
            "rolled sheet (0.85 to 1.15) to layers at 45 degrees (2.4)"
        )
        coupling = (
            "from woven carbon and unidirectional laminates (0.15 to 0.3) over rolled sheet (0.85 to 1.15) to layers "
            "at 45 degrees (2.5), below the limit at which bending into a saddle needs no energy; the least stands for "
            "none as well, of corrugated sheet or some woods"
        )
        return (
            Parameter("ratio", "-", 1 / 25, 25.0, why, log=True),
            Parameter("shear_ratio", "-", 0.15, 2.5, shear, log=True, default=HUBER),
            Parameter(
                "coupling",
                "-",
                0.15,
                self._most(predictor),
                coupling,
                log=True,
                default=HUBER,
                natural=("low",),
            ),
        )

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a grid: where modes change places the likelihood has maxima of its own."""
        _, shear, coupling = self.parameters(predictor)
        middle, usual = shear.coordinate(HUBER), coupling.coordinate(HUBER)
        ratios = ((i + 0.5) / STARTS_ALONG for i in range(STARTS_ALONG))
        return tuple((u, v, usual) for u in ratios for v in (middle - 0.25, middle, middle + 0.15))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the plate with its terms across and in twist scaled."""
        factors = {
            ACROSS: values["ratio"],
            TWIST: values.get("shear_ratio", HUBER),
            COUPLING: values.get("coupling", HUBER),
        }
        return State(factors=factors)

    @staticmethod
    def _most(predictor: Predictor) -> float:
        """Return the firmest coupling of the model's material."""
        return min(2.5, FIRMEST / max(predictor.spec.material.poisson, 1e-9))

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the modulus of shear in the plane over E_x, which is what the twist determines."""
        isotropic = 1 / (2 * (1 + predictor.spec.material.poisson))
        twist = isotropic * math.sqrt(values["ratio"]) * values.get("shear_ratio", HUBER)
        return {"shear_over_E": (twist, "-")}
