"""What imported modes become where the parts change: static answers, of which those count that hold energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse

MODES = 15
"""Lowest modes whose answers are worked out [-]: with four of them the tenth mode of a block is 1 % off where a region
has 0.7 of its modulus, with fifteen 0.01 %; twice as many halve that and double the columns."""

LOADS = 300
"""Most answers that are worked out [-]: of 100 000 unknowns each takes a second or two."""

ENERGY = 3e-4
"""Directions stay whose strain energy, of a part that changes by all it has, is more than this share of the mode's [-]:
a change by a third then leaves half of a ninth of it, some 0.002 %, in a frequency; a third of it adds a fifth to the
columns."""


def part_answers(
    solve: Callable[[FloatArray], FloatArray],
    matrices: tuple[Sparse, Sparse],
    parts: tuple[Sequence[Sparse], Sequence[Sparse]],
    modes: tuple[FloatArray, FloatArray, int],
) -> FloatArray:
    """Return the main directions of the static answers to a change of each part in the lowest modes.

    The first terms of the series of combined approximations (Kirsch, Int. J. Numer. Meth. Engng 35 (1992)):
    K^-1 K_p phi and K^-1 lambda M_p phi, each over the root of lambda, what the modes hold of them taken out.

    Parameters
    ----------
    solve : callable
        Takes loads (n, k) to static answers.
    matrices : stiffness, mass
        Of the whole, (n, n) [SI].
    parts : two sequences of (n, n) sparse arrays
        Of the stiffness and of the mass [SI].
    modes : eigenvalues, vectors, first
        All modes of the basis (m,) [rad^2/s^2] and (n, m) [kg^-1/2], and how many of them are rigid.

    Returns
    -------
    (n, k) array
        Orthonormal in the stiffness.
    """
    values, vectors, first = modes
    count = max(4, min(MODES, LOADS // max(len(parts[0]) + len(parts[1]), 1)))
    low = vectors[:, first : first + count]
    root = np.sqrt(np.abs(values[first : first + count]))
    loads = [part @ (low / root) for part in parts[0]] + [part @ (low * root) for part in parts[1]]
    if not loads:
        return np.zeros((len(vectors), 0))
    answers = solve(np.hstack(loads))
    answers -= vectors @ (vectors.T @ (matrices[1] @ answers))
    energy, directions = np.linalg.eigh(answers.T @ (matrices[0] @ answers))
    kept = energy > ENERGY
    return np.asarray(answers @ (directions[:, kept] / np.sqrt(energy[kept])))
