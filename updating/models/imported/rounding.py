"""How well the digits of a file state a stiffness, and which motions may therefore have none.

Every entry of a file of d significant digits is off by up to half a unit of its last digit. The strain energy
v^T K v of a motion v is then off by up to u |v|^T |K| |v|, with u = 10^(1 - d) / 2 (Wilkinson, *Rounding Errors in
Algebraic Processes*, 1963): energy within this bound cannot be distinguished from zero.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.models.fields import Sparse

EPS = float(np.finfo(float).eps)
"""Distance of 1 from the next larger double [-]."""

FEWEST, MOST = 5, 14
"""Significant digits of files that are rounded [-]: short formats have five, and more than fourteen cannot be
distinguished from double precision."""


NEEDED = 3
"""So many times as many numbers need the last digit as end before it, if they are rounded [-]: three is the middle of
one and nine on a scale of ratios."""


def decimal_rounding(matrix: Sparse) -> float:
    """Return half a unit of the last digit that a matrix was written with, 0 where it was not rounded [-].

    Relative to the entry. Of numbers rounded to d digits nine times as many need the last one as end a digit before it;
    numbers that are exact, such as 2000 or 78750, end anywhere.
    """
    size = np.abs(matrix.data)
    size = size[size > np.finfo(float).tiny * 10.0**MOST]  # of smaller ones no power of ten makes whole units
    for digits in range(FEWEST, MOST + 1):
        if _written(size[:1000], digits).all() and _written(size, digits).all():
            kinds = np.unique(size)
            shorter, shortest = _written(kinds, digits - 1), _written(kinds, digits - 2)
            rounded = (~shorter).sum() >= NEEDED * (1 + (shorter & ~shortest).sum())
            return 0.5 * 10.0 ** (1 - digits) if rounded else 0.0
    return 0.0


def _written(size: FloatArray, digits: int) -> BoolArray:
    """Return which numbers are those of so many significant digits."""
    units = size * 10.0 ** (digits - 1 - np.floor(np.log10(size)))
    return np.asarray(np.abs(units - np.round(units)) <= 4 * EPS * units)


def relative_rounding(matrix: Sparse, decimal: float = 0.0) -> float:
    """Return the relative error of entries: of their digits, at most 15, or of the sums that made them [-].

    Parameters
    ----------
    matrix : (n, n) sparse array
        A stiffness.
    decimal : float
        Half a unit of the last digit of its file; 0 if it was not rounded [-].
    """
    longest = int(np.diff(matrix.indptr).max(initial=1))
    return max(decimal, 0.5 * 10.0 ** (1 - np.finfo(float).precision), longest * EPS)


def energies(matrix: Sparse, vectors: FloatArray, relative: float) -> tuple[FloatArray, FloatArray]:
    """Return twice the strain energies of motions (n, k), and their bounds of rounding, each (k,) [J]."""
    found = np.einsum("ij,ij->j", vectors, matrix @ vectors)
    size = np.abs(vectors)
    return found, relative * np.einsum("ij,ij->j", size, abs(matrix) @ size)


def without_stiffness(matrix: Sparse, vectors: FloatArray, relative: float) -> BoolArray:
    """Tell of which motions (n, k) the strain energy is within rounding of zero, (k,)."""
    found, bound = energies(matrix, vectors, relative)
    return np.asarray(np.abs(found) <= bound)
