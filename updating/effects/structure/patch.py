"""A layer that sticks to a part of the structure: tape, paint, putty, a constrained layer."""

from __future__ import annotations

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import Place, covered, mirror_images, place, shares, starting_places
from updating.effects.obstacles import Lack, Obstacle, damping_obstacle
from updating.effects.regions import region_centre, region_parameter, stiff_regions
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor


class DampingPatch(Effect):
    """A layer on a stretch of a beam, on a square of a plate, or on a region of imported matrices.

    The covered part has a structural ``loss_factor`` eta: K (1 + i eta) there. ``mass`` and ``stiffness`` are what
    the layer adds, relative to the bare structure's own mass per area and bending stiffness [-].
    """

    name = "damping_patch"
    channel = "damping"
    summary = "A layer on part of the structure (tape, paint, putty) damps it there."
    footprint = (
        "Damping rises in the modes that bend there; frequencies follow the layer's mass and stiffness."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("uniform_damping",)
    repeats = True
    separated_by = "take the layer off, or more modes whose curvature differs along the structure"
    phrase = "a damping patch"
    fidelity = 0.05

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extent, loss factor, and what the layer adds of mass and stiffness."""
        lossy = "from tape, which must damp to be one, to a constrained layer that covers the part well"
        heavy = "share of the bare structure's mass there: a layer, no body"
        stiff = "share of the bare structure's stiffness there: a layer, no rib"
        layer = (
            Parameter("loss_factor", "-", 5e-3, 0.5, lossy, log=True),
            Parameter("mass", "-", 0.0, 0.12, heavy, natural=("low",)),
            Parameter("stiffness", "-", 0.0, 0.12, stiff, natural=("low",)),
        )
        spec = predictor.spec
        if spec.kind == "matrices":
            return (region_parameter(predictor), *layer)
        middle = [Parameter("x", "m", 0.0, spec.length, "anywhere along the structure", natural=EDGES)]
        if spec.kind == "plate":
            middle.append(
                Parameter("y", "m", 0.0, spec.width, "anywhere across the structure", natural=EDGES)
            )
        why = "what is shorter hardly damps, what covers more is all over"
        return (
            *middle,
            Parameter("extent", "m", 0.05 * spec.length, 0.6 * spec.length, why, log=True),
            *layer,
        )

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping, and regions where there are matrices."""
        if predictor.spec.kind == "matrices" and len(stiff_regions(predictor)) < 2:
            what = "the matrices have no stiffness_parts: nothing can stick to a part; give one per region"
            return Obstacle(Lack.MODEL, what)
        return damping_obstacle(predictor)

    def damps(self, parameter: str = "") -> bool:
        """Tell that the loss factor does, and nothing else."""
        return parameter == "loss_factor"

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the damping alone, and with mass and stiffness; of imported matrices for each region."""
        bare = {"mass": 0.0, "stiffness": 0.0}
        if predictor.spec.kind != "matrices":
            return (Variant(bare, 0.6), Variant(weight=0.4))
        regions = stiff_regions(predictor)
        alone = tuple(Variant({"region": i, **bare}, 0.6 / len(regions)) for i in regions)
        return (*alone, *(Variant({"region": i}, 0.4 / len(regions)) for i in regions))

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places, a fifth of the length long."""
        if predictor.spec.kind == "matrices":
            return tuple((0.5, u, 0.1, 0.1) for u in (0.3, 0.7))
        return tuple((*where, 0.6, 0.55, 0.1, 0.1) for where in starting_places(predictor.spec))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the layer."""
        stiffness, mass = self._covered(predictor, values)
        return State(
            stiffness=(values["stiffness"] * stiffness,) if values["stiffness"] else (),
            mass=(values["mass"] * mass,) if values["mass"] else (),
            losses=(Loss(values["loss_factor"] * (1 + values["stiffness"]) * stiffness, -1.0),),
        )

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return the mass of the layer on a beam or plate, which stays on when the specimen is weighed [kg]."""
        if not values["mass"] or not predictor.spec.outlined:
            return 0.0
        sizes = predictor.reduced.fields.weights
        under = float(sizes @ shares(predictor, values) / sizes.sum())
        return float(values["mass"]) * under * total_mass(predictor.spec)

    def _covered(self, predictor: Predictor, values: Values) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and mass of the bare structure under the layer, each (r, r) [SI]."""
        reduced, factors = predictor.reduced, predictor.base.factors
        if predictor.spec.kind == "matrices":
            parts = dict.fromkeys(("stiffness", "mass"), 0.0 * reduced.sums[0])
            for term, regions in zip(reduced.structure.terms, reduced.parts, strict=True):
                parts[term.kind] = parts[term.kind] + term.scale(factors) * regions[int(values["region"])]
            return parts["stiffness"], parts["mass"]
        inside = shares(predictor, values)
        stiffness = covered(predictor, "stiffness", inside)
        return stiffness, covered(predictor, "mass", inside) if values["mass"] else stiffness

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the place, and its mirror images where nothing but damping could tell them apart."""
        if predictor.spec.kind == "matrices":
            return (region_centre(predictor, int(values["region"])),)
        at, stated = place(values), predictor.measured.has_shapes and (values["mass"] or values["stiffness"])
        return (at,) if stated else mirror_images(predictor.spec, at)

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return loss factor times length covered, which data determine better than either."""
        if predictor.spec.kind == "matrices":
            return {}
        return {"cover": (values["loss_factor"] * values["extent"], "m")}
