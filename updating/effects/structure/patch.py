"""A layer that sticks to a part of the structure: tape, paint, putty, a constrained layer."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import (
    Place,
    covered,
    extent_parameters,
    mirror_images,
    outline,
    place,
    shares,
    starting_places,
)
from updating.effects.mechanism import Size
from updating.effects.obstacles import Lack, Obstacle, damping_obstacle
from updating.effects.regions import region_centre, regions_meant, stiff_regions
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

LAWS = {"loss_factor": 0.6, "alpha": 0.2, "beta": 0.2}
"""By what a layer loses, and the prior of each [-]: most by a loss factor; loose ones by a force in proportion to mass,
viscous ones to stiffness. Judged; doubled, one gains ln 2."""

BARE = 0.6
"""Prior of a layer that adds neither mass nor stiffness that data show [-]."""

EXTENTS = (0.05, 0.6)
"""Extents relative to the side [-]."""

LOSSES = (5e-3, 0.5)
"""Range of the loss factor; of the other laws, what they make of one in the middle of the measured band [-]."""


class DampingPatch(Effect):
    """A layer on a stretch of a beam, on a rectangle of a plate, or on a region of imported matrices.

    The covered part loses by a structural ``loss_factor`` eta, K (1 + i eta) there, or by ``alpha`` and ``beta``,
    C = alpha M + beta K there. ``mass`` and ``stiffness`` are what the layer adds, relative to the bare structure's own
    mass per area and bending stiffness [-].
    """

    name = "damping_patch"
    channel = "damping"
    summary = "A layer on part of the structure (tape, paint, putty) damps it there."
    footprint = (
        "Damping rises in the modes that bend there; frequencies follow the layer's mass and stiffness."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("uniform_damping", "local_mass")
    named = ("region",)
    repeats = True
    separated_by = "take the layer off, or more modes whose curvature differs along the structure"
    phrase = "a damping patch"
    fidelity = 0.05

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extents, losses, and what the layer adds of mass and stiffness."""
        lossy = "from tape with little damping to a constrained layer that covers the part well"
        heavy = "share of the bare structure's mass there: a layer, not a body"
        stiff = "share of the bare structure's stiffness there: a layer, not a rib"
        hertz = predictor.measured.frequency
        middle = 2 * np.pi * float(np.sqrt(hertz.min() * hertz.max()))
        low, high = LOSSES
        same = "loss in proportion to {}; in the middle of the band that of the loss factors"
        layer = (
            Parameter("loss_factor", "-", low, high, lossy, log=True),
            Parameter(
                "alpha", "1/s", low * middle, high * middle, same.format("mass"), log=True, like="nothing"
            ),
            Parameter(
                "beta", "s", low / middle, high / middle, same.format("stiffness"), log=True, like="nothing"
            ),
            Parameter("mass", "-", 0.0, 0.12, heavy, natural=("low",)),
            Parameter("stiffness", "-", 0.0, 0.12, stiff, natural=("low",)),
        )
        spec = predictor.spec
        if spec.kind == "matrices":
            return layer
        why = "a shorter layer hardly damps; a longer one covers the whole structure"
        return (*outline(predictor), *extent_parameters(spec, *EXTENTS, why), *layer)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping, and regions where there are matrices."""
        if predictor.spec.kind == "matrices" and len(stiff_regions(predictor)) < 2:
            what = (
                "the matrices have no stiffness_parts: no layer can be added to a part; give one per region"
            )
            return Obstacle(Lack.MODEL, what)
        return damping_obstacle(predictor)

    def damps(self, parameter: str = "") -> bool:
        """State that what loses does, and nothing else."""
        return parameter in LAWS

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the damping alone and with mass and stiffness, by each law; of imported matrices for each region.

        By alpha and beta with mass and stiffness only, of regions alone only: the two hold what the other would.
        """
        regional = predictor.spec.kind == "matrices"
        known = [{"region": name} for name in stiff_regions(predictor)] if regional else [{}]
        bare = {"mass": 0.0, "stiffness": 0.0}
        found = []
        for law, share in LAWS.items():
            others = {other: 0.0 for other in LAWS if other != law}
            forms = [(BARE, others | bare), (1 - BARE, others)]
            if law != "loss_factor":
                forms = [(1.0, forms[0 if regional else 1][1])]
            found += [
                Variant({**own, **form}, part * share / len(known)) for part, form in forms for own in known
            ]
        return tuple(found)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places, a fifth of the length long."""
        if predictor.spec.kind == "matrices":
            return tuple((u, u, u, 0.1, 0.1) for u in (0.3, 0.7))
        layer = (*(0.6,) * predictor.spec.dim, 0.55, 0.55, 0.55, 0.1, 0.1)
        return tuple((*where, *layer) for where in starting_places(predictor.spec))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the layer."""
        alpha, beta = (float(values.get(name, 0.0)) for name in ("alpha", "beta"))
        stiffness, mass = self._covered(predictor, values, mass=bool(values["mass"] or alpha))
        losses = [Loss(values["loss_factor"] * (1 + values["stiffness"]) * stiffness, -1.0)]
        if alpha:
            losses.append(Loss(alpha * (1 + values["mass"]) * mass, 0.0))
        if beta:
            losses.append(Loss(beta * (1 + values["stiffness"]) * stiffness, 0.0))
        return State(
            stiffness=(values["stiffness"] * stiffness,) if values["stiffness"] else (),
            mass=(values["mass"] * mass,) if values["mass"] else (),
            losses=tuple(losses),
        )

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return the mass of the layer on a beam or plate, which stays on when the specimen is weighed [kg]."""
        if not values["mass"] or not predictor.spec.outlined:
            return 0.0
        sizes = predictor.reduced.fields.weights
        under = float(sizes @ shares(predictor.reduced.fielded, values) / sizes.sum())
        return float(values["mass"]) * under * total_mass(predictor.spec)

    def _covered(self, predictor: Predictor, values: Values, *, mass: bool) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and mass of the bare structure under the layer, each (r, r) [SI]."""
        reduced, factors = predictor.reduced, predictor.base.factors
        if predictor.spec.kind == "matrices":
            meant = regions_meant(predictor.spec, values)
            parts = dict.fromkeys(("stiffness", "mass"), 0.0 * reduced.sums[0])
            for term, regions in zip(reduced.structure.terms, reduced.parts, strict=True):
                parts[term.kind] = parts[term.kind] + term.scale(factors) * sum(regions[i] for i in meant)
            return parts["stiffness"], parts["mass"]
        inside = shares(predictor.reduced.fielded, values)
        stiffness = covered(predictor, "stiffness", inside)
        return stiffness, covered(predictor, "mass", inside) if mass else stiffness

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the place, and its mirror images where nothing but damping could separate them."""
        if predictor.spec.kind == "matrices":
            return (region_centre(predictor, values),)
        at, stated = place(values), predictor.measured.has_shapes and (values["mass"] or values["stiffness"])
        return (at,) if stated else mirror_images(predictor.spec, at)

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the loss factor times the length covered, or the coefficient by which it loses."""
        if "cover" in (cover := self.derived(predictor, values)):
            return (Size("loss factor times length", *cover["cover"]),)
        laws = (p for p in self.parameters(predictor) if values.get(p.name) and p.name in LAWS)
        return tuple(Size(p.name.replace("_", " "), float(values[p.name]), p.unit) for p in laws)[:1]

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return loss factor times length covered, which data determine better than either."""
        if predictor.spec.kind == "matrices" or not values["loss_factor"]:
            return {}
        return {"cover": (values["loss_factor"] * values["extent"], "m")}
