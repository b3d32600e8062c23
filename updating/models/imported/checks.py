"""Whether two matrices can be the stiffness and the mass of one structure; if not, which row shows it."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.ordering import factored

SYMMETRY = 1e-6
"""Largest difference of a matrix and its transpose that is rounding, relative to its entries' size [-]."""

INDEFINITE = 1e-6
"""A negative eigenvalue of the scaled mass matrix beyond this is no rounding [-]."""

NOTHING = 1e-11
"""What a whole has beyond its parts is nothing below this share of the diagonals [-]: rounding of fourteen digits, and
what is left of all else in a part (one in 10^12). A soft spring on a stiff shell is a millionth, and moves modes."""

SLOWEST = 1.0
"""Stiffness over mass of a single row that no structure made of solids has [rad^2/s^2]."""

HEAVIER = 1e5
"""How far above the highest ratio of stiffness to mass that of a massless degree of freedom is put [-]."""


def symmetric(matrix: Sparse, source: str) -> Sparse:
    """Return a symmetric matrix; one of which a single triangle is stored is completed.

    Raises
    ------
    StudyError
        If it is not square, not finite, or not symmetric.
    """
    rows, columns = matrix.shape
    if rows != columns:
        raise StudyError(f"{source}: the matrix is {rows} x {columns}; stiffness and mass are square")
    if not np.isfinite(matrix.data).all():
        raise StudyError(f"{source}: an entry is not finite")
    lower, upper = sparse.tril(matrix, -1), sparse.triu(matrix, 1)
    if (lower.nnz == 0) != (upper.nnz == 0):
        return Sparse(matrix + lower.T + upper.T)
    difference = abs(matrix - matrix.T).tocoo()
    scale = np.sqrt(np.maximum(np.abs(matrix.diagonal()), 1e-300))
    with np.errstate(over="ignore"):  # beside nothing on the diagonal any number is too much
        size = difference.data / (scale[difference.row] * scale[difference.col])
    if size.max(initial=0.0) > SYMMETRY:
        worst = int(np.argmax(size))
        i, j = int(difference.row[worst]), int(difference.col[worst])
        raise StudyError(
            f"{source}: not symmetric: row {i + 1}, column {j + 1} holds {matrix[i, j]:.6g} and its mirror image "
            f"{matrix[j, i]:.6g}; gyroscopic, follower or contact terms are not supported"
        )
    return Sparse((matrix + matrix.T) / 2)


def check_size(stiffness: Sparse, mass: Sparse, source: str) -> None:
    """See that there is stiffness, and that it is not the mass.

    Raises
    ------
    StudyError
        If the stiffness is empty, or so small beside the mass that the two must be in each other's place.
    """
    stiff, heavy = stiffness.diagonal(), mass.diagonal()
    if not stiffness.count_nonzero():
        raise StudyError(f"{source}: the stiffness matrix is empty")
    both = (stiff > 0) & (heavy > 0)
    if both.any() and (ratio := float(np.median(stiff[both] / heavy[both]))) < SLOWEST:
        raise StudyError(
            f"{source}: stiffness over mass is {ratio:.3g} rad^2/s^2 on the diagonals: are the two matrices "
            "swapped, or in different units?"
        )


def with_mass_everywhere(stiffness: Sparse, mass: Sparse, source: str) -> Sparse:
    """Return a mass matrix that is positive on every row.

    A degree of freedom without mass follows the others statically (Guyan 1965). It is given the mass that puts it at
    a hundred thousand times the highest ratio of stiffness to mass elsewhere: a beam's rotations then have a radius of
    gyration of a two-thousandth of an element, and a mode of ten elements per wave moves by a millionth.

    Raises
    ------
    StudyError
        If a row is empty in both matrices, or a diagonal entry is negative or zero beside others that are not.
    """
    size = np.sqrt(np.asarray(abs(mass).sum(axis=1)).ravel()), np.asarray(abs(stiffness).sum(axis=1)).ravel()
    empty = np.flatnonzero((size[0] == 0) & (size[1] == 0))
    if len(empty):
        raise StudyError(
            f"{source}: row {empty[0] + 1} is empty in stiffness and mass ({len(empty)} such rows): singular; leave "
            "out degrees of freedom that a support holds"
        )
    diagonal, stiff = mass.diagonal(), stiffness.diagonal()
    wrong = np.flatnonzero((diagonal < 0) | ((diagonal == 0) & (size[0] > 0)))
    if len(wrong):
        raise StudyError(
            f"{source}: mass matrix indefinite: row {wrong[0] + 1} has {diagonal[wrong[0]]:.6g} on its diagonal"
        )
    massless = np.flatnonzero(size[0] == 0)
    if len(massless) == len(diagonal):
        raise StudyError(f"{source}: the mass matrix is empty")
    if not len(massless):
        return mass
    soft = massless[stiff[massless] <= 0]
    if len(soft):
        raise StudyError(
            f"{source}: row {soft[0] + 1} has no mass and {stiff[soft[0]]:.6g} on the stiffness's diagonal: singular"
        )
    heavy = diagonal > 0
    highest = float((stiff[heavy] / diagonal[heavy]).max())
    added = np.zeros(len(diagonal))
    added[massless] = stiff[massless] / (HEAVIER * highest)
    return Sparse(mass + sparse.diags_array(added))


def check_mass(mass: Sparse, source: str, places: FloatArray | None = None) -> None:
    """See that a mass matrix with a positive diagonal has no negative eigenvalue.

    Zero is allowed: elements with reduced integration have motions without mass, which their stiffness holds.
    ``places`` (n, 3) states where the rows are [m].

    Raises
    ------
    StudyError
        If there is a motion of negative mass.
    """
    scale = sparse.diags_array(1 / np.sqrt(mass.diagonal()))
    scaled = scale @ mass @ scale + INDEFINITE * sparse.eye_array(mass.shape[0])
    found = negative_pivots(factored(Sparse(scaled), places))
    if found is not None:
        count, row = found
        raise StudyError(
            f"{source}: mass matrix indefinite: {count} motion(s) have a negative mass, the first found at row {row}"
        )


def negative_pivots(factor: Any) -> tuple[int, int] | None:
    """Return how many eigenvalues are negative (Sylvester's law of inertia) and a row that shows it, or None."""
    pivots = factor.U.diagonal()
    if not (factor.perm_r == factor.perm_c).all() or not (pivots < 0).any():
        return None
    first = int(np.flatnonzero(pivots < 0)[0])
    return int((pivots < 0).sum()), int(np.flatnonzero(factor.perm_c == first)[0]) + 1


def check_sum(whole: Sparse, parts: tuple[Sparse, ...], sources: tuple[str, ...], name: str) -> Sparse | None:
    """Return what a whole has beyond the sum of its parts, None where there is nothing.

    A remainder is allowed where the parts leave something out; parts that hold more than the whole are not.

    Raises
    ------
    StudyError
        If a part has another order, or is not contained in the whole.
    """
    if not parts:
        return None
    n = whole.shape[0]
    for part, source in zip(parts, sources, strict=True):
        if part.shape[0] != n:
            raise StudyError(f"{source}: a part of order {part.shape[0]} of a {name} of order {n}")
    rest = Sparse(whole - sum(parts[1:], start=parts[0]))
    diagonal = whole.diagonal()
    rounding = SYMMETRY * np.maximum(np.abs(diagonal), 1e-300)
    for part, source in zip(parts, sources, strict=True):
        if (wrong := part.diagonal() < -10 * rounding).any():
            row = int(np.flatnonzero(wrong)[0])
            raise StudyError(
                f"{source} of the {name}: row {row + 1} has {part.diagonal()[row]:.6g} on its diagonal; a region's own "
                "matrix is not negative"
            )
    lacking = rest.diagonal() < -10 * rounding
    if lacking.any():
        together = np.asarray(sum(p.diagonal() for p in parts))
        largest = np.maximum(np.maximum(np.abs(diagonal), np.abs(together)), 1e-300)
        row = int(np.argmin(rest.diagonal() / largest))
        total = float(together[row])
        raise StudyError(
            f"{name}_parts: they sum to more than the {name}: row {row + 1} has {total:.6g} on the diagonal of their "
            f"sum and {diagonal[row]:.6g} in the whole; give each region's own matrix, made with the same mesh"
        )
    scale = np.sqrt(np.abs(diagonal))
    entries = rest.tocoo()
    size = np.abs(entries.data) / np.maximum(scale[entries.row] * scale[entries.col], 1e-300)
    return None if not len(size) or size.max() <= NOTHING else rest
