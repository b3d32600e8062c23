"""The water around the structure: its inertia and its viscosity."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, total_mass
from updating.effects.mechanism import MASS_RATIO, Size
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.effects.structure.wetted import (
    OPEN,
    at_a_wall,
    shorter_side,
    surroundings,
    unit_mass,
    unstated,
    wetted,
)
from updating.fluid import edge_reach, layer_depth, slip_matrix, unbounded
from updating.fluid.tank import NEAREST
from updating.models.absorbers import structural
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

WATER = 998.0
"""Density of the fluid where neither the study nor an accepted effect states it [kg/m^3]."""

TYPICAL = 4
"""So many of the model's modes stand for those of a test that has not been made."""

USUAL = 1e-3
"""Viscosity of water, for the depth of the layer at edges, on which hardly anything depends [Pa s]."""

LIQUIDS = (600.0, 1500.0)
"""Densities of what is no gas [kg/m^3]: pentane 626, petrol 740, alcohols 790, oils 800 to 930, water 998, sea water
1025, glycol 1113, glycerine 1261, saturated brines to 1400. Gases shift nothing that can be seen. With twice the range
in the logarithm every other cause gains ln 2 in all odds against a fluid."""

FARTHEST = 3.0
"""Largest distance of surface and bottom, over the longer side [-]: of a tank that holds the structure; three sides are
as good as none, 0.3 % of the added mass of a square plate. Doubled: deep water gains a seventh of the prior."""

LEVEL_DOUBT = 0.05
"""How far the level of the added mass may be off, in all modes alike, where neither density nor walls are stated, 1
sigma [-]. Judged: walls that are not stated add 6 % half a width away, 2 % one width away (bench_water_plates.py), and
frequencies of a plate measured in a tank are 1 to 1.5 % off, some 3 % of the added mass. All modes share it, so no
number of them makes up for it. Doubled: a density is known to a fifth."""

DEEP, NEAR = 0.8, 0.3
"""Prior quantiles of distances to start a search from: two and a third of a plate's shorter sides [-]."""


WALL = Parameter(
    "wall",
    "-",
    0.0,
    1.0,
    "0: water flows round the clamp; 1: the clamp is an endless wall",
    default=1.0,
    natural=EDGES,
)
"""Share of an endless wall in the clamp: the added mass lies between that with the wall and that without. Of paper A's
plate no wall takes 0.1 to 6.5 % off its twelve lowest modes."""


class FluidAddedMass(Effect):
    """Inertia of a still, heavy fluid on both faces, under a surface, above a bottom: potential flow, no factor."""

    name = "fluid_added_mass"
    channel = "mass"
    summary = "The surrounding fluid moves with the structure and adds its inertia."
    footprint = (
        "Frequencies fall strongly, more for modes of long waves than for short waves and torsion, and the level falls "
        "with them. A near surface reduces the fall, a near bottom increases it, for long waves from farther away."
    )
    equivalent_to = ("density",)
    separated_by = "the same test dry; or a second depth of immersion"

    phrase = "the mass of the fluid around it"
    undone_by = frozenset({"in air"})
    fidelity = 0.06
    uneven = True
    damping_doubt = 0.5
    """A fluid damps, by an amount that is not known here: in water Stokes' layer alone adds 0.03 to 0.3 % to the ratios
    of paper A's structures, a tenth to all of what light steel has dry; eddies and waves come on top."""

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the density of the fluid, and the distances of surface and bottom that the study does not state."""
        stated = predictor.environment.fluid_density
        low, high = (0.97 * stated, 1.03 * stated) if stated is not None else LIQUIDS
        why = "liquids from pentane over oils, alcohols and water to brines; gases cause no detectable shift"
        why = why if stated is None else "the study states it"
        doubt = LEVEL_DOUBT if stated is None and predictor.environment.walls is None else 0.0
        density = Parameter("fluid_density", "kg/m^3", low, high, why, log=stated is None, scale_doubt=doubt)
        distances = (_distance(predictor, name) for name in unstated(predictor.environment))
        return (density, *distances, *((WALL,) if at_a_wall(predictor) else ()))

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from deep water, and from a near surface or bottom where nothing is stated of these."""
        count = len(unstated(predictor.environment))
        near = [tuple(NEAR if k == which else DEEP for k in range(count)) for which in range(count)]
        wall = (0.5,) * at_a_wall(predictor)
        return tuple((0.5, *start, *wall) for start in ((DEEP,) * count, *near))

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the fluid's inertia."""
        around = surroundings(predictor, values)
        distances = {"free_surface": unbounded(around.free_surface), "bottom": unbounded(around.bottom)}
        density = values["fluid_density"]
        return State(
            mass=(density * _unit_mass(predictor, values),), fluid={"fluid_density": density, **distances}
        )

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the fluid's share in the first mode's mass over the structure's own: what frequencies determine.

        A denser fluid under a nearer surface adds as much; on a slender beam no mode separates the two.
        """
        first = predictor.once("first mode", lambda: _first_mode(predictor))
        added = _unit_mass(predictor, values)[: len(first), : len(first)]
        return {"added_mass_ratio": (values["fluid_density"] * float(first @ added @ first), "-")}

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return what the fluid adds in the first mode, per area of the structure and over its own mass."""
        ratio, unit = self.derived(predictor, values)["added_mass_ratio"]
        own = total_mass(predictor.spec) / (predictor.spec.length * predictor.spec.width)
        return Size("added mass per area", ratio * own, "kg/m^2"), Size(MASS_RATIO, ratio, unit)


class FluidDamping(Effect):
    """Stokes' boundary layer of a viscous fluid at rest on both faces, along which the potential flow slides."""

    name = "fluid_damping"
    channel = "damping"
    summary = "The surrounding fluid is viscous: its boundary layer takes energy out of every mode."
    footprint = (
        "Damping ratios rise, in proportion to one over the root of frequency; the relative fall of each frequency "
        "equals the rise of its damping ratio."
    )
    equivalent_to = ("uniform_damping",)
    separated_by = "the same test dry; or in a fluid of the same density and another viscosity"

    phrase = "the viscosity of the fluid around it"
    undone_by = frozenset({"in air"})
    fidelity = 0.15

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the viscosity; what counts is its product with the density."""
        density = fluid_density(predictor)
        why = f"from volatile solvents to heavy oil, at a density of {density:.4g} kg/m^3"
        return (Parameter("viscosity", "Pa s", 1e-4, 1.0, why, log=True),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping."""
        return damping_obstacle(predictor)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the layer's losses, which grow with the root of frequency."""
        slip = predictor.once("slip", lambda: _unit_slip(predictor))
        return State(
            losses=(Loss(math.sqrt(0.5 * fluid_density(predictor) * values["viscosity"]) * slip, 0.5),)
        )

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return the product of density and viscosity, which is what damping determines."""
        return {"density_viscosity": (fluid_density(predictor) * values["viscosity"], "kg^2/(m^4 s)")}


def _unit_mass(predictor: Predictor, values: Values) -> FloatArray:
    """Return the added mass of a fluid of unit density, at a clamp that is a wall in part, (r, r) [m^3 in w]."""
    around, wall = surroundings(predictor, values), float(values.get("wall", 1.0))
    whole = unit_mass(predictor, around)
    if wall == 1.0 or not at_a_wall(predictor):
        return whole
    return wall * whole + (1.0 - wall) * unit_mass(predictor, replace(around, walls=OPEN))


def _distance(predictor: Predictor, name: str) -> Parameter:
    """Return a distance and its prior [m]."""
    low = NEAREST * shorter_side(predictor.spec)
    high = FARTHEST * max(predictor.spec.length, predictor.spec.width)
    why = "from a tenth of the shorter side (close to surface or bottom) to three times the longer side"
    return Parameter(name, "m", low, high, why, log=True, default=math.inf, natural=EDGES)


def _first_mode(predictor: Predictor) -> FloatArray:
    """Return the structure in the lowest elastic mode, of unit modal mass, on the reduced basis, (r,) [kg^-1/2]."""
    _, vectors = predictor.reduced.eigen(predictor.base)
    return structural(vectors, predictor.base.absorbers)[:, predictor.reduced.structure.rigid_modes]


def fluid_density(predictor: Predictor) -> float:
    """Return the density of the fluid [kg/m^3]: of an accepted added mass, of the environment, or water's."""
    stated = predictor.environment.fluid_density
    return predictor.base.fluid.get("fluid_density") or (WATER if stated is None else stated)


def _unit_slip(predictor: Predictor) -> FloatArray:
    """Return the slip of both faces in the reduced basis, (r, r) [m^2 in w]."""
    wet = wetted(predictor, surroundings(predictor, predictor.base.fluid))
    known = predictor.measured.frequency
    known = known if len(known) else predictor.predict(count=TYPICAL).frequency
    typical = math.exp(float(np.mean(np.log(known))))
    layer = layer_depth(USUAL, fluid_density(predictor), typical)
    reach = edge_reach(min(wet.length, wet.width), wet.thickness, layer)
    return slip_matrix(wet.operator(0.0), wet.shapes, wet.x, wet.y, reach=reach)
