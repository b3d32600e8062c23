"""Columns of a reduced basis: those that join it, those of parts of clamped edges, those that a state leaves out."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.models.edges import static_lifts
from updating.models.fields import Sparse
from updating.models.structure import FieldStructure

ROUNDING = 1e-10
"""What is left of a vector below this share is rounding [-]."""


def extend_basis(
    basis: FloatArray, extra: FloatArray, mass: Sparse, *, tolerance: float = 1e-9
) -> FloatArray:
    """Append the directions of ``extra`` that ``basis`` lacks, orthonormal in the mass."""
    before = np.einsum("ij,ij->j", extra, mass @ extra)
    for _ in range(2):
        extra = extra - basis @ (basis.T @ (mass @ extra))
    extra = extra[:, np.einsum("ij,ij->j", extra, mass @ extra) > ROUNDING**2 * before]
    if not extra.shape[1]:
        return basis
    gram = extra.T @ (mass @ extra)
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    values, vectors = np.linalg.eigh(gram / np.outer(scale, scale))
    keep = values > tolerance * max(values.max(), 1e-300)
    new = (extra / scale) @ (vectors[:, keep] / np.sqrt(values[keep]))
    new = new - basis @ (basis.T @ (mass @ new))
    return np.hstack([basis, new])


def columns_along(
    structure: FieldStructure, clamped: FloatArray, mass: Sparse, behind: int
) -> tuple[FloatArray, dict[str, slice]]:
    """Return the columns that parts of clamped edges need where they let go, and where each edge has its own.

    Those of one edge and kind are orthonormal to the clamped columns and among themselves, not to others: to be so they
    would have to take up what another edge moves by.

    Parameters
    ----------
    structure : FieldStructure
        The plate.
    clamped : (n_dofs, n) array
        Columns of the clamped plate, orthonormal in the mass.
    mass : (n_dofs, n_dofs) sparse array
        Its mass [kg].
    behind : int
        How many columns there are before these.
    """
    columns, places = [], {}
    for name in structure.along:
        own = extend_basis(clamped, static_lifts(structure, name), mass)[:, clamped.shape[1] :]
        places[name] = slice(behind, behind + own.shape[1])
        columns.append(own)
        behind += own.shape[1]
    return np.hstack(columns), places


def cut_off(stiffness: FloatArray, mass: FloatArray, idle: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return the matrices with idle columns (r,) cut off from all else, on a frequency above every other."""
    above = 1e3 * float(np.abs(np.diag(stiffness)[~idle]).max())
    used = np.outer(~idle, ~idle)
    return np.where(used, stiffness, above * np.diag(idle)), np.where(used, mass, np.diag(idle) * 1.0)
