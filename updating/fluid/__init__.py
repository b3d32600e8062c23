"""Added mass and viscous damping of plates and beams in a fluid at rest, by potential flow."""

from .domain import FluidDomain
from .galerkin import energy_matrix
from .operator import AddedMassOperator
from .plate import added_mass, beam_added_mass, beam_matrix, beam_operator, quadrature_grid
from .section import heave_coefficient, strip_theory
from .stokes import edge_reach, layer_depth, slip_coefficient, slip_matrix
from .tank import TankTable, unbounded

__all__ = [
    "AddedMassOperator",
    "FluidDomain",
    "TankTable",
    "added_mass",
    "beam_added_mass",
    "beam_matrix",
    "beam_operator",
    "edge_reach",
    "energy_matrix",
    "heave_coefficient",
    "layer_depth",
    "quadrature_grid",
    "slip_coefficient",
    "slip_matrix",
    "strip_theory",
    "unbounded",
]
