"""Masses on springs that a state hangs on a structure: each adds a degree of freedom behind those of the basis.

With the displacement u of the mass and w = a^T q of the place that it hangs from, the spring stores k (u - w)^2 / 2,
the dashpot dissipates c (u' - w')^2 / 2 and the mass has m u'^2 / 2 (Den Hartog, Mechanical Vibrations, section 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from acquisition.arrays import FloatArray

Kind = Literal["stiffness", "mass", "damping"]


@dataclass(frozen=True, eq=False)
class Absorber:
    """A mass on a spring and a dashpot.

    Parameters
    ----------
    row : (r,) array
        Displacement of the place that it hangs from, in the coordinates of the reduced basis [kg^-1/2].
    mass, stiffness, damping : float
        Of the mass [kg], the spring [N/m] and the dashpot [N s/m].
    attached : bool
        Whether the spring is the structure's own flexibility at the place: a body that sits there swings by itself far
        above all that is measured, and takes part in the structure's modes like its own mass.
    """

    row: FloatArray
    mass: float
    stiffness: float
    damping: float
    attached: bool = False

    def size(self, kind: Kind) -> float:
        """Return its stiffness [N/m], mass [kg] or damping [N s/m]."""
        return float(getattr(self, kind))


def bordered(matrix: FloatArray, absorbers: Sequence[Absorber], kind: Kind) -> FloatArray:
    """Add absorbers to a matrix of the structure, each a row and a column behind it.

    Parameters
    ----------
    matrix : (n, n) array
        Stiffness, mass or damping of the structure on the leading n columns of the basis [SI].
    absorbers : sequence of k Absorber
        What hangs on it.
    kind : {"stiffness", "mass", "damping"}
        Which matrix.

    Returns
    -------
    (n + k, n + k) array [SI]
    """
    n, count = len(matrix), len(absorbers)
    whole = np.zeros((n + count, n + count))
    whole[:n, :n] = matrix
    for i, one in enumerate(absorbers):
        across = np.zeros(n + count)
        across[n + i] = 1.0
        if kind != "mass":
            across[:n] = -one.row[:n]
        whole += one.size(kind) * np.outer(across, across)
    return whole


def padded(rows: FloatArray, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return rows of the basis (..., r) with what they are of the absorbers' own degrees of freedom: nothing."""
    return np.pad(rows, [(0, 0)] * (rows.ndim - 1) + [(0, len(absorbers))])


def structural(vectors: FloatArray, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return what vectors (n + k, m) are of the structure, (n, m)."""
    return vectors[: len(vectors) - len(absorbers)]


def swinging(absorbers: Sequence[Absorber]) -> tuple[Absorber, ...]:
    """Return those that make a mode of their own: all but bodies on the flexibility of their place."""
    return tuple(one for one in absorbers if not one.attached)


def own_flexibility(n: int, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return the stiffness on which bodies are attached to a structure of n columns, (n + k, n + k) [SI]."""
    springs = [replace(one, stiffness=one.stiffness if one.attached else 0.0) for one in absorbers]
    return bordered(np.zeros((n, n)), springs, "stiffness")


def motions(vectors: FloatArray, absorbers: Sequence[Absorber]) -> tuple[FloatArray, FloatArray]:
    """Return how the masses move in modes (n + k, m), and how they move against their places, each (k, m)."""
    n = len(vectors) - len(absorbers)
    own = vectors[n:]
    rows = np.array([one.row[:n] for one in absorbers]).reshape(len(absorbers), n)
    return own, own - rows @ vectors[:n]


def energies(vectors: FloatArray, absorbers: Sequence[Absorber]) -> dict[Kind, FloatArray]:
    """Return what absorbers add to phi^T K phi, phi^T M phi and phi^T C phi of modes (n + k, m), each (m,) [SI].

    The flexibility on which a body is attached is the structure's: nothing is added to its stiffness.
    """
    own, against = motions(vectors, absorbers)
    parts: dict[Kind, FloatArray] = {"stiffness": against, "mass": own, "damping": against}
    sizes = {kind: np.array([one.size(kind) for one in absorbers]) for kind in parts}
    sizes["stiffness"] = np.where([one.attached for one in absorbers], 0.0, sizes["stiffness"])
    return {kind: np.asarray(sizes[kind] @ part**2) for kind, part in parts.items()}


def swinging_mass(vectors: FloatArray, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return the share in the modal mass of modes (n + k, m) of what makes modes of its own, (m,) [-]."""
    sizes = np.array([0.0 if one.attached else one.mass for one in absorbers])
    return np.asarray(sizes @ motions(vectors, absorbers)[0] ** 2)
