"""A place that is softer than modelled: a crack, a notch, a loose rivet row."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant
from updating.effects.box import SOFT, Place, mirror_images, place, shares, starting_places
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import region_centre, region_parameter, stiff_regions
from updating.models.softening import softening
from updating.models.state import State
from updating.prediction.predict import Predictor

COMPLIANCE = (5e-4, 0.6)
"""Range of the compliance, the integral of EI0/EI - 1, relative to the length [-]."""

REGIONAL = (5e-3, 20.0)
"""Range of E0/E - 1 of a region of imported matrices [-]."""

MOST = 0.98
"""Largest loss of stiffness [-]."""


class LocalStiffness(Effect):
    """Bending stiffness lost over a stretch of a beam, a square of a plate, or in a region of imported matrices."""

    name = "local_stiffness"
    channel = "stiffness"
    summary = "One place is softer than modelled (crack, notch, loose joint)."
    footprint = "Frequencies fall in the modes that bend there, and hardly in those with no curvature there."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("clamp_rotation",)
    repeats = True
    separated_by = "more points around the place, or a visual and dye check there"
    phrase = "a soft spot"
    fidelity = 0.05  # some 0.03 of a sharp-edged place seen as one with soft edges, 0.02 of the condensation

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extent and loss; of imported matrices the region and its loss."""
        spec = predictor.spec
        lost = Parameter(
            "loss",
            "-",
            0.0,
            MOST,
            "from invisible to nearly severed; uniform in log compliance",
            natural=EDGES,
        )
        if spec.kind == "matrices":
            return (region_parameter(predictor), lost)
        middle = [Parameter("x", "m", 0.0, spec.length, "anywhere along the structure", natural=EDGES)]
        if spec.kind == "plate":
            middle.append(
                Parameter("y", "m", 0.0, spec.width, "anywhere across the structure", natural=EDGES)
            )
        low, high = 0.02 * spec.length, 0.15 * spec.length
        why = "what is longer is a region, not a place; what is shorter makes no other change than this"
        return (*middle, Parameter("extent", "m", low, high, why, log=True, natural=("low",)), lost)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need regions where there are matrices."""
        if predictor.spec.kind != "matrices" or len(stiff_regions(predictor)) > 1:
            return None
        what = "the matrices have no stiffness_parts: nothing can soften at a place; give one per region"
        return Obstacle(Lack.MODEL, what)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return one form for each region of imported matrices."""
        if predictor.spec.kind != "matrices":
            return (Variant(),)
        regions = stiff_regions(predictor)
        return tuple(Variant({"region": i}, 1 / len(regions)) for i in regions)

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values: the last one is that of the compliance, which the data determine."""
        values = super().values(predictor, coordinates)
        if predictor.spec.kind == "matrices":
            softer = REGIONAL[0] * (REGIONAL[1] / REGIONAL[0]) ** coordinates[-1]
            return values | {"region": round(values["region"]), "loss": min(softer / (1 + softer), MOST)}
        low, high = (share * predictor.spec.length for share in COMPLIANCE)
        compliance = low * (high / low) ** coordinates[-1]
        return values | {"loss": min(compliance / (compliance + values["extent"]), MOST)}

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places, with a middling loss."""
        if predictor.spec.kind == "matrices":
            return ((0.5, 0.3), (0.5, 0.7))
        return tuple((*where, 0.5, 0.45) for where in starting_places(predictor.spec))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with its stiffness reduced there."""
        if predictor.spec.kind == "matrices":
            return State(regional={(int(values["region"]), "E"): 1 - values["loss"]})
        factors = predictor.base.factors
        if predictor.spec.kind == "beam" or predictor.reduced.whole:
            lost = self._softening(predictor, values)
            return State(stiffness=(-predictor.reduced.weighted("stiffness", lost, factors),))
        inside = shares(predictor, values, soft=SOFT)
        return State(stiffness=(softening(predictor.reduced).change(inside, values["loss"], factors),))

    def _softening(self, predictor: Predictor, values: Values) -> FloatArray:
        """Return the share of the stiffness lost at every quadrature point [-]: a box with soft edges."""
        return np.asarray(values["loss"] * shares(predictor, values, soft=SOFT))

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the place; where no shapes tell it from its mirror images, these too."""
        if predictor.spec.kind == "matrices":
            return (region_centre(predictor, int(values["region"])),)
        at = place(values)
        return (at,) if predictor.measured.has_shapes else mirror_images(predictor.spec, at)

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the compliance, the integral of EI0/EI - 1 along x: what the data determine."""
        if predictor.spec.kind == "matrices":
            return {"compliance": (values["loss"] / (1 - values["loss"]), "-")}
        lost = self._softening(predictor, values)
        across = 1.0
        if predictor.spec.kind == "plate":
            low, high = (values["y"] + side * values["extent"] / 2 for side in (-1, 1))
            across = min(high, predictor.spec.width) - max(low, 0.0)
        compliance = float(predictor.reduced.fields.weights @ (1 / (1 - lost) - 1)) / across
        return {"compliance": (compliance, "m")}
