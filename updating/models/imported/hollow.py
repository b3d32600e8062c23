"""Motions with neither stiffness nor mass, which elements of reduced integration leave where one is as thick as all."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.ordering import factored
from updating.models.imported.rounding import without_stiffness

LOST = 1e-10
"""A pivot below this share of its diagonal entry has lost all its digits [-]."""

NOTHING = 1e-9
"""Below this share of what each of its rows has, a motion has nothing [-]."""


def check_hollow(
    stiffness: Sparse, mass: Sparse, factor: Any, source: str, places: FloatArray | None = None
) -> None:
    """See that no motion has neither stiffness nor mass, where pivots of the factored sum have lost their digits.

    Such motions are eigenvectors to zero of K and M added, the sum scaled by its diagonal.

    Raises
    ------
    StudyError
        If there is one: its frequency could be anything.
    """
    entries = np.abs(stiffness.diagonal())[np.argsort(factor.perm_c)]
    if (np.abs(factor.U.diagonal()) > LOST * entries).all():
        return
    both = _ones_on_diagonal(Sparse(_level(stiffness) + _level(mass)))
    one = sparse.eye_array(both.shape[0])
    below, above = (factored(Sparse(both + shift * one), places) for shift in (NOTHING, -NOTHING))
    count = int((above.U.diagonal() < 0).sum())
    if (below.U.diagonal() < 0).any() or not count:
        return
    row = int(np.flatnonzero(above.perm_c == int(np.flatnonzero(above.U.diagonal() < 0)[0]))[0]) + 1
    raise StudyError(
        f"{source}: singular: {count} motion(s) have neither stiffness nor mass, one shows at row {row}; "
        "a single layer of reduced-integration elements (C3D20R) leaves such: use C3D20, or two layers"
    )


def hold_hollow_rows(stiffness: Sparse, massless: IntArray, relative: float) -> Sparse:
    """Return a stiffness with a spring at one row of every motion of massless rows that has no stiffness either.

    A pinned bar without rotary inertia may spin so. Neither matrix couples such a motion with any other, so that a
    spring at one of its rows changes nothing but its own frequency, which could be anything.

    Parameters
    ----------
    stiffness : (n, n) sparse array
        The stiffness [SI].
    massless : (m,) int array
        Rows without mass.
    relative : float
        Relative error of the stiffness's entries [-].
    """
    block = _ones_on_diagonal(Sparse(stiffness[massless][:, massless]))
    held = Sparse(block + relative * sparse.eye_array(len(massless)))
    factor = factored(held)
    bound = relative * (1 + int(np.diff(block.indptr).max())) * len(massless)
    added = np.zeros(stiffness.shape[0])
    for row in np.flatnonzero(factor.U.diagonal()[factor.perm_c] <= bound).tolist():
        motion = factor.solve(np.eye(1, len(massless), row).ravel())[:, None]
        if without_stiffness(block, motion, relative)[0]:
            added[massless[row]] = stiffness.diagonal()[massless[row]]
    return Sparse(stiffness + sparse.diags_array(added)) if added.any() else stiffness


def _level(matrix: Sparse) -> Sparse:
    """Return a matrix over the middle of its diagonal."""
    diagonal = np.abs(matrix.diagonal())
    return Sparse(matrix / float(np.median(diagonal[diagonal > 0]))) if (diagonal > 0).any() else matrix


def _ones_on_diagonal(matrix: Sparse) -> Sparse:
    """Return a matrix with its rows and columns scaled to ones on the diagonal."""
    diagonal = np.abs(matrix.diagonal())
    scale = sparse.diags_array(1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))
    return Sparse(scale @ matrix @ scale)
