"""A region of imported matrices heavier or lighter than modelled."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.box import Place
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import heavy_regions, region_centre, regions_meant
from updating.models.state import State
from updating.prediction.predict import Predictor

FACTORS = (0.25, 4.0)
"""Range of the factor on a region's mass [-]: from a hollow part to one that carries three times itself."""


class LocalMass(Effect):
    """The mass of a region, off by a factor."""

    name = "local_mass"
    channel = "mass"
    summary = "One region is heavier (filling, cladding, an unmodelled load) or lighter than modelled."
    footprint = "Frequencies fall, or rise, in the modes that move there; those with a node there hardly do."
    phrase = "a region of another mass"
    models = ("matrices",)
    equivalent_to = ("lumped_mass",)
    named = ("region",)
    repeats = True
    separated_by = "weigh the part; or more points on it"
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the factor."""
        why = "from a part that is hollow to one that carries three times its own mass"
        return (Parameter("factor", "-", *FACTORS, why, log=True),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need regions with masses of their own."""
        if len(heavy_regions(predictor)) > 1:
            return None
        what = "the matrices have no mass_parts: nothing can be heavier at a place; give one per region"
        return Obstacle(Lack.MODEL, what)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each region."""
        names = heavy_regions(predictor)
        return tuple(Variant({"region": name}, 1 / len(names)) for name in names)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a region lighter and one heavier, by little, from where modes keep their order, and by much."""
        return ((0.3,), (0.45,), (0.55,), (0.7,))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the region's mass changed."""
        factor = float(values["factor"])
        return State(regional={(i, "density"): factor for i in regions_meant(predictor.spec, values)})

    def sentence(self, values: Values) -> str:
        """Return which region, and whether it is heavier or lighter."""
        more = (
            "lighter than modelled"
            if values.get("factor", 1.0) < 1
            else "heavier than modelled (filling, cladding)"
        )
        return f"{values.get('region', 'One region')} is {more}."

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return what the region weighs more than modelled [kg]."""
        imported = predictor.spec.imported
        if imported is None:
            return 0.0
        parts = [imported.mass_parts[i] for i in regions_meant(predictor.spec, values)]
        along = np.asarray(imported.places.moves[imported.main_axis].sum(axis=0)).ravel() > 0
        return float((values["factor"] - 1) * sum(along @ (part @ along) for part in parts))

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the middle of the region."""
        return (region_centre(predictor, values),)
