"""Matrices in the units of whoever made them, taken to metres, kilograms and seconds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from scipy import sparse

from acquisition.errors import StudyError
from acquisition.units import INCH, POUND
from updating.models.fields import Sparse
from updating.models.imported.nodes import NodeTable

SI = "m-kg-s"

UNITS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {SI: (1.0, 1.0), "mm-t-s": (1e-3, 1.0), "in-lbf-s": (INCH, POUND)}
)
"""Length [m] and force [N] of systems of units; mass is force times second squared per length."""


def units_of(name: str) -> tuple[float, float]:
    """Return length [m] and force [N] of a system of units.

    Raises
    ------
    StudyError
        If it is unknown.
    """
    if name not in UNITS:
        raise StudyError(f"unknown units {name!r}; known: {', '.join(UNITS)}")
    return UNITS[name]


def places_in_si(table: NodeTable, name: str) -> NodeTable:
    """Return a node table with its coordinates in metres."""
    length, _ = units_of(name)
    return table if name == SI else replace(table, places=table.places * length)


def matrix_in_si(matrix: Sparse, table: NodeTable, name: str) -> Sparse:
    """Return a stiffness or mass matrix for displacements in metres and rotations in radians.

    Energy is force times length in either system; a displacement is divided by the length, a rotation is not.
    """
    length, force = units_of(name)
    if name == SI:
        return matrix
    if matrix.shape[0] != matrix.shape[1]:
        return matrix  # refused later, with its name
    per_row = np.full(matrix.shape[0], 1 / length)
    turning = table.row[(table.direction > 3) & (table.row >= 0)]
    per_row[turning[turning < len(per_row)]] = 1.0
    scale = sparse.diags_array(per_row)
    return Sparse((force * length) * (scale @ matrix @ scale))
