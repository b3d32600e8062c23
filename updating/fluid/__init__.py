"""Added mass of plates and beams in a fluid at rest, by potential flow."""

from .domain import FluidDomain
from .operator import AddedMassOperator
from .plate import added_mass, beam_added_mass, beam_matrix, beam_operator, quadrature_grid
from .section import heave_coefficient, strip_theory

__all__ = [
    "AddedMassOperator",
    "FluidDomain",
    "added_mass",
    "beam_added_mass",
    "beam_matrix",
    "beam_operator",
    "heave_coefficient",
    "quadrature_grid",
    "strip_theory",
]
