"""The water around the structure."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values
from updating.fluid import FluidDomain, added_mass, beam_added_mass, quadrature_grid
from updating.models.state import State
from updating.prediction import Predictor


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

    fidelity = 0.06

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the density of the fluid."""
        told = predictor.environment.fluid_density
        if told is not None:
            return (Parameter("fluid_density", "kg/m^3", 0.97 * told, 1.03 * told, "the study states it"),)
        why = "liquids from light oils to brines; gases shift nothing that can be seen"
        return (Parameter("fluid_density", "kg/m^3", 100.0, 2000.0, why, log=True),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the fluid's inertia."""
        unit = predictor.once("fluid", lambda: _unit_mass(predictor))
        return State(mass=(values["fluid_density"] * unit,))


def _unit_mass(predictor: Predictor) -> FloatArray:
    """Return the added mass of a fluid of unit density in the reduced basis, (r, r) [m^3 in w]."""
    spec, around = predictor.spec, predictor.environment
    domain = FluidDomain(around.free_surface, around.bottom, around.walls)
    size = {"length": spec.length, "width": spec.width, "thickness": spec.thickness}
    x, y = quadrature_grid(spec.length, spec.width, 24)
    if spec.kind == "beam":
        return beam_added_mass(predictor.reduced.rows(x[:, None])["w"].T, x, **size, domain=domain)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    shapes = predictor.reduced.rows(points)["w"].T.reshape(-1, len(x), len(y))
    return added_mass(shapes, x, y, **size, domain=domain)
