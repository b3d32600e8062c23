"""The water around the structure: its inertia and its viscosity."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.environment import Environment
from updating.fluid import (
    AddedMassOperator,
    FluidDomain,
    edge_reach,
    layer_depth,
    quadrature_grid,
    slip_matrix,
)
from updating.models.spec import Spec
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

WATER = 998.0
"""Density of the fluid where neither the study nor an accepted effect says it [kg/m^3]."""

TYPICAL = 4
"""So many of the model's modes stand for those of a test that has not been made."""

USUAL = 1e-3
"""Viscosity of water, for the depth of the layer at edges, on which hardly anything depends [Pa s]."""


class FluidAddedMass(Effect):
    """Inertia of a still, heavy fluid on both faces: potential flow, no fitted factor."""

    name = "fluid_added_mass"
    channel = "mass"
    summary = "The surrounding fluid moves with the structure and adds its inertia."
    footprint = (
        "Frequencies fall strongly, modes of long waves more than modes of short waves and of torsion."
    )
    equivalent_to = ("density",)
    separated_by = "the same test dry; or a second depth of immersion"

    phrase = "the mass of the fluid around it"
    undone_by = frozenset({"in air"})
    fidelity = 0.06
    damping_doubt = 0.5
    """A fluid damps, and how much nothing here says: in water Stokes' layer alone adds 0.03 to 0.3 % to the ratios
    of paper A's structures, a tenth to all of what light steel has dry; eddies and waves come on top."""

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the density of the fluid."""
        stated = predictor.environment.fluid_density
        if stated is not None:
            return (
                Parameter("fluid_density", "kg/m^3", 0.97 * stated, 1.03 * stated, "the study states it"),
            )
        why = "liquids from light oils to brines; gases shift nothing that can be seen"
        return (Parameter("fluid_density", "kg/m^3", 100.0, 2000.0, why, log=True),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the fluid's inertia."""
        return State(mass=(values["fluid_density"] * unit_mass(predictor),))


class FluidDamping(Effect):
    """Stokes' boundary layer of a viscous fluid at rest on both faces, along which the potential flow slides."""

    name = "fluid_damping"
    channel = "damping"
    summary = "The surrounding fluid is viscous: its boundary layer takes energy out of every mode."
    footprint = (
        "Damping ratios rise, with the inverse root of frequency; "
        "each frequency falls by as much as its ratio rises."
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


def fluid_density(predictor: Predictor) -> float:
    """Return the density of the fluid [kg/m^3]: of an accepted added mass, of the environment, or water's."""
    stated = predictor.environment.fluid_density
    if predictor.base.mass:
        unit = unit_mass(predictor)
        for mass in predictor.base.mass:
            density = float(np.vdot(mass, unit) / np.vdot(unit, unit))
            if density > 0.0 and np.allclose(mass, density * unit, rtol=1e-9, atol=1e-9 * np.abs(mass).max()):
                return density
    return WATER if stated is None else stated


def unit_mass(predictor: Predictor) -> FloatArray:
    """Return the added mass of a fluid of unit density in the reduced basis, (r, r) [m^3 in w]."""
    return predictor.once("fluid", lambda: mass_within(predictor, predictor.environment))


def mass_within(predictor: Predictor, around: Environment, *, thickness: float | None = None) -> FloatArray:
    """Return the same for given surroundings.

    Parameters
    ----------
    predictor : Predictor
        The structure.
    around : Environment
        Free surface, bottom and walls.
    thickness : float, optional
        Thickness that the fluid meets, in place of the structure's; zero is a thin plate [m].

    Returns
    -------
    (r, r) array [m^3 in w]
    """
    wet = _wetted(predictor, around)
    operator = wet.operator(wet.thickness if thickness is None else thickness)
    return operator.matrix(wet.shapes, wet.x, wet.y)


def _unit_slip(predictor: Predictor) -> FloatArray:
    """Return the slip of both faces in the reduced basis, (r, r) [m^2 in w]."""
    wet = _wetted(predictor, predictor.environment)
    known = predictor.measured.frequency
    known = known if len(known) else predictor.predict(count=TYPICAL).frequency
    typical = math.exp(float(np.mean(np.log(known))))
    layer = layer_depth(USUAL, fluid_density(predictor), typical)
    reach = edge_reach(min(wet.length, wet.width), wet.thickness, layer)
    return slip_matrix(wet.operator(0.0), wet.shapes, wet.x, wet.y, reach=reach)


@dataclass(frozen=True, eq=False)
class _Wetted:
    """The part of the structure that the fluid touches, in axes that begin at its edges."""

    length: float
    width: float
    thickness: float
    domain: FluidDomain
    x: FloatArray
    y: FloatArray
    shapes: FloatArray

    def operator(self, thickness: float) -> AddedMassOperator:
        return AddedMassOperator.build(
            length=self.length, width=self.width, thickness=thickness, domain=self.domain
        )


def _domain(spec: Spec, around: Environment) -> FluidDomain:
    """Return what bounds the fluid. Where no walls are told, the one clamped edge stands at a wall of its own.

    A clamp is a body through which nothing flows. Of several clamped edges nothing of the kind is assumed.
    """
    walls, free = around.walls, float("inf")
    if walls is None and len(spec.clamped) == 1:
        low, high = {"x": (0.0, spec.length), "y": (0.0, spec.width)}[spec.clamped[0][0]]
        sides = [(-free, free), (-free, free)]
        sides["xy".index(spec.clamped[0][0])] = (low, free) if spec.clamped[0][1] == "0" else (-free, high)
        walls = (*sides[0], *sides[1])
    return FluidDomain(around.free_surface, around.bottom, walls)


def _wetted(predictor: Predictor, around: Environment) -> _Wetted:
    """Return what is wet, and the shapes of the reduced basis there, (r, nx, ny).

    A structure that an accepted ``length`` makes longer bends inside its clamps, where no fluid is; a shorter
    one ends where it ends.
    """
    predictor.reduced.refuse_whole("a fluid's pressure, which couples every point to every other")
    spec = predictor.spec
    stretch = predictor.base.factors.get("length", 1.0)
    start = -predictor.growth * (stretch - 1.0)
    end = start + spec.length * stretch
    low = max(start, 0.0) if "x0" in spec.clamped else start
    high = min(end, spec.length) if "x1" in spec.clamped else end
    x, y = quadrature_grid(high - low, spec.width, 24)
    aside = 0.5 * spec.width if spec.kind == "beam" else 0.0
    walls = _domain(spec, around).shifted(aside, dx=-low)
    along = (x + low - start) / stretch
    if spec.kind == "beam":
        y = np.array([0.0, spec.width])
        shapes = np.repeat(predictor.reduced.rows(along[:, None])["w"].T[:, :, None], 2, axis=2)
    else:
        points = np.stack(np.meshgrid(along, y, indexing="ij"), axis=-1).reshape(-1, 2)
        shapes = predictor.reduced.rows(points)["w"].T.reshape(-1, len(x), len(y))
    return _Wetted(high - low, spec.width, spec.thickness, walls, x, y, shapes)
