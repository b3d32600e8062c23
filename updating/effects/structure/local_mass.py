"""A place heavier or lighter than modelled: a coating, ice, a plate glued on, a cover; a hollow, a lighter insert."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Parameter, Values
from updating.effects.box import (
    extents,
    spread,
    starting_places,
)
from updating.effects.mechanism import ADDED_MASS, Size
from updating.effects.regions import heavy_regions, regions_meant
from updating.effects.structure.either_way import EitherWay
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

LARGE = 0.65
"""Quantile, within a form, of the size from which a search starts where frequencies do not decide [-]."""

SCREENED = (0.05, 0.4, 0.75)
"""Quantiles of the extents at which places are screened [-]. What is long is found from what is short, what is short
hardly from what is long: the first stands at all of them."""


class LocalMass(EitherWay):
    """Another mass per area, as stiff as before, on a stretch of a beam, a rectangle of a plate, a region of matrices.

    ``factor`` is that of the mass per area, which moves across the structure and has no rotary inertia of its sections.
    What data determine is the mass added, in which the prior is uniform in the logarithm on either side.
    """

    name = "local_mass"
    channel = "mass"
    summary = (
        "One place is heavier (coating, ice, filling, cladding) or lighter than modelled, as stiff as before."
    )
    footprint = "Frequencies fall, or rise, in the modes that move there; those with a node there hardly do."
    phrase = "a place of another mass"
    equivalent_to = ("lumped_mass", "density", "damping_patch")
    screened = MappingProxyType({"extent": SCREENED})
    separated_by = "find the added part and weigh it; or measure more points on it"
    fidelity = 0.03

    among = (0.05, 0.4)  # a third of the side with some room
    why = "a longer one is the whole structure; a shorter one has the effect of a body"
    lacking = "the matrices have no mass_parts: the mass of a place cannot be changed; give one per region"
    upper = 0.8
    """What is stuck on and not modelled is far commoner than what is missing and took no stiffness with it. Judged; the
    lighter one's share doubled, it gains ln 2."""

    def changed(self, predictor: Predictor) -> Parameter:
        """Return the factor on the mass."""
        why = "from a part that is hollow to one that carries three times its own mass"
        if self.two_sided(predictor):
            why += "; uniform in the logarithm of the mass on either side"
        return Parameter("factor", "-", *FACTORS, why, log=True)

    def regions(self, predictor: Predictor) -> Sequence[str]:
        """Return those with masses of their own."""
        return heavy_regions(predictor)

    def two_sided(self, predictor: Predictor) -> bool:
        """Return whether it is a place: the factor of a region is one form."""
        return predictor.spec.kind != "matrices"

    def size(self, value: float) -> float:
        """Return the mass added over the place's own [-]."""
        return value - 1

    def value(self, size: float) -> float:
        """Return the factor with which so much is added."""
        return 1 + size

    def size_range(self, predictor: Predictor, values: Values, *, upper: bool) -> tuple[float, float]:
        """Return the range of the size of the change of mass, relative to the place's own [-]."""
        spec, (along, across) = predictor.spec, extents(values)
        share = along / spec.length * (across / spec.width if spec.kind == "plate" else 1.0)
        return LEAST / share, FACTORS[1] - 1 if upper else 1 - FACTORS[0]

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

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the mass added, which data determine better than the factor; negative of a lighter place."""
        if predictor.spec.kind == "matrices":
            return {}
        return {"mass": (self.weight(predictor, values), "kg")}


def _modelled(predictor: Predictor, values: Values) -> tuple[FloatArray, FloatArray]:
    """Return points all over the place (n, dim) [m], and what the structure weighs about each as modelled (n,) [kg]."""
    rough = predictor.spec.kind == "plate" and not predictor.reduced.whole  # on a basis of smooth shapes
    points, sizes = spread(predictor.spec, values, by_elements=not rough)
    terms = predictor.reduced.fielded.terms
    moving = next(term for term in terms if (term.kind, term.left, term.right) == ("mass", "w", "w"))
    own = modelled_mass(predictor.spec, regions_at(predictor.spec, points))
    return points, own * sizes * moving.scale(predictor.base.factors)
