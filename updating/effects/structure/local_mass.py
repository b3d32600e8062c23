"""A place heavier or lighter than modelled: a coating, ice, a plate glued on, a cover; a hollow, a lighter insert."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.box import (
    Place,
    extent_parameters,
    extents,
    outline,
    place,
    spread,
    starting_places,
    where_alike,
)
from updating.effects.mechanism import ADDED_MASS, Size
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import heavy_regions, region_centre, regions_meant
from updating.models.state import State
from updating.models.structure import regions_at
from updating.models.terms import modelled_mass
from updating.prediction.predict import Predictor

FACTORS = (0.25, 4.0)
"""Range of the factor on the mass of a region or a place [-]: from a hollow part to one that carries three times its
own, as steel on aluminium does. Doubled at its upper end, a small heavy body passes for a place, too."""

LEAST = 1e-3
"""Smallest mass added or missing over the structure's own [-]: what repeated tests can see, as of a body. Doubled, a
coating of a thousandth is found by no search."""

EXTENTS = (0.05, 0.4)
"""Extents relative to the side: what is shorter moves as a body does; a third with some room [-]."""

HEAVIER, LIGHTER = (0.5, 1.0), (0.0, 0.5)
"""The two forms, each half of the quantiles of the factor, nothing in the middle."""

LARGE = 0.65
"""Quantile, within a form, of the size from which a search starts where frequencies do not decide [-]."""

SCREENED = (0.05, 0.4, 0.75)
"""Quantiles of the extents at which places are screened [-]. What is long is found from what is short, what is short
hardly from what is long: the first stands at all of them."""

SHARE_HEAVIER = 0.8
"""Prior of the heavier form [-]: what is stuck on and not modelled is far commoner than what is missing and took no
stiffness with it. Judged; the lighter one's share doubled, it gains ln 2."""


class LocalMass(Effect):
    """Another mass per area, as stiff as before, on a stretch of a beam, a rectangle of a plate, a region of matrices.

    ``factor`` is that of the mass per area, which moves across the structure and has no rotary inertia of its sections.
    What data determine is the mass added, in which the prior is uniform in the logarithm on either side.
    """

    name = "local_mass"
    channel = "mass"
    summary = (
        "One place is heavier (coating, ice, filling, cladding) or lighter than modelled, as stiff as before."
    )
    keeps_clamps = True
    footprint = "Frequencies fall, or rise, in the modes that move there; those with a node there hardly do."
    phrase = "a place of another mass"
    models = ("beam", "plate", "matrices")
    equivalent_to = ("lumped_mass", "density", "damping_patch")
    named = ("region",)
    screened = MappingProxyType({"extent": SCREENED})
    repeats = True
    separated_by = "find the added part and weigh it; or measure more points on it"
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extents and factor; of imported matrices the factor of a region."""
        spec = predictor.spec
        why = "from a part that is hollow to one that carries three times its own mass"
        if spec.kind == "matrices":
            return (Parameter("factor", "-", *FACTORS, why, log=True),)
        why += "; uniform in the logarithm of the mass on either side"
        factor = Parameter("factor", "-", *FACTORS, why, log=True)
        why = "a longer one is the whole structure; a shorter one has the effect of a body"
        return (*outline(predictor), *extent_parameters(spec, *EXTENTS, why, natural=("low",)), factor)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need regions with masses of their own where there are matrices."""
        if predictor.spec.kind != "matrices" or len(heavy_regions(predictor)) > 1:
            return None
        what = "the matrices have no mass_parts: the mass of a place cannot be changed; give one per region"
        return Obstacle(Lack.MODEL, what)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return heavier and lighter; of imported matrices each region."""
        if predictor.spec.kind == "matrices":
            names = heavy_regions(predictor)
            return tuple(Variant({"region": name}, 1 / len(names)) for name in names)
        halves = ((SHARE_HEAVIER, HEAVIER), (1 - SHARE_HEAVIER, LIGHTER))
        return tuple(Variant(weight=share, within={"factor": half}) for share, half in halves)

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values: the last one is that of the mass added, which the data determine."""
        values = super().values(predictor, coordinates)
        if predictor.spec.kind != "matrices":
            u = coordinates[-1]
            low, high = _changes(predictor, values, heavier=u >= 0.5)
            size = float(low * (high / low) ** abs(2 * u - 1))
            values["factor"] = 1 + size if u >= 0.5 else 1 - size
        return values

    def quantiles(self, predictor: Predictor, values: Values) -> list[float]:
        """Take values to prior quantiles; of the factor that of its mass."""
        found = super().quantiles(predictor, values)
        if "factor" in values and "extent" in values:
            heavier, size = values["factor"] >= 1, abs(values["factor"] - 1)
            low, high = _changes(predictor, values, heavier=heavier)
            half = float(np.clip(np.log(max(size, low) / low) / np.log(high / low), 0.0, 1.0)) / 2
            found[-1] = 0.5 + half if heavier else 0.5 - half
        return found

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of short places either way.

        Of imported matrices from regions little and much lighter and heavier: from little, modes keep their order.
        """
        if predictor.spec.kind == "matrices":
            return ((0.3,), (0.45,), (0.55,), (0.7,))
        short = (SCREENED[0],) * predictor.spec.dim
        row = [(*at, *short) for at in starting_places(predictor.spec)]
        return tuple((*at, 0.5 + side * LARGE / 2) for side in (1, -1) for at in row)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with its mass changed there."""
        factor = float(values["factor"])
        if predictor.spec.kind == "matrices":
            return State(regional={(i, "density"): factor for i in regions_meant(predictor.spec, values)})
        points, masses = _modelled(predictor, values)
        rows = predictor.reduced.rows(points)["w"] * np.sqrt(masses)[:, None]
        return State(mass=((factor - 1) * (rows.T @ rows),))

    def sentence(self, values: Values) -> str:
        """Return where it is, and whether it is heavier or lighter."""
        more = (
            "lighter than modelled"
            if values.get("factor", 1.0) < 1
            else "heavier than modelled (coating, ice, filling, cladding)"
        )
        return f"{values.get('region', 'One place')} is {more}, as stiff as before."

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return what it weighs more than modelled [kg]."""
        imported = predictor.spec.imported
        if imported is None:
            return float((values["factor"] - 1) * _modelled(predictor, values)[1].sum())
        parts = [imported.mass_parts[i] for i in regions_meant(predictor.spec, values)]
        along = np.asarray(imported.places.moves[imported.main_axis].sum(axis=0)).ravel() > 0
        return float((values["factor"] - 1) * sum(along @ (part @ along) for part in parts))

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the mass over what is modelled there."""
        return (Size(ADDED_MASS, self.weight(predictor, values), "kg"),)

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the middle; where no shapes separate it from its mirror images, these too."""
        if predictor.spec.kind == "matrices":
            return (region_centre(predictor, values),)
        at = place(values)
        return where_alike(predictor, at)

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the mass added, which data determine better than the factor; negative of a lighter place."""
        if predictor.spec.kind == "matrices":
            return {}
        return {"mass": (self.weight(predictor, values), "kg")}


def _changes(predictor: Predictor, values: Values, *, heavier: bool) -> tuple[float, float]:
    """Return the range of the size of the change of mass, relative to the place's own [-]."""
    spec, (along, across) = predictor.spec, extents(values)
    share = along / spec.length * (across / spec.width if spec.kind == "plate" else 1.0)
    return LEAST / share, FACTORS[1] - 1 if heavier else 1 - FACTORS[0]


def _modelled(predictor: Predictor, values: Values) -> tuple[FloatArray, FloatArray]:
    """Return points all over the place (n, dim) [m], and what the structure weighs about each as modelled (n,) [kg]."""
    rough = predictor.spec.kind == "plate" and not predictor.reduced.whole  # on a basis of smooth shapes
    points, sizes = spread(predictor.spec, values, by_elements=not rough)
    terms = predictor.reduced.fielded.terms
    moving = next(term for term in terms if (term.kind, term.left, term.right) == ("mass", "w", "w"))
    own = modelled_mass(predictor.spec, regions_at(predictor.spec, points))
    return points, own * sizes * moving.scale(predictor.base.factors)
