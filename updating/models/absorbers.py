"""Masses on springs that a state hangs on a structure: each adds a degree of freedom behind those of the basis.

With the displacement u of the mass and w = a^T q of the place that it hangs from, the spring stores k (u - w)^2 / 2,
the dashpot dissipates c (u' - w')^2 / 2 and the mass has m u'^2 / 2 (Den Hartog, Mechanical Vibrations, section 3.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray

Kind = Literal["stiffness", "mass", "damping"]

CLEAR = 8
"""So many modes beyond those asked for take part where dashpots couple them: what lies further off is moved by the
square of its coupling over its distance [-]. Doubled: no pole moves by 1e-4 of its damping."""


@dataclass(frozen=True, eq=False)
class Absorber:
    """A mass on a spring and a dashpot.

    Parameters
    ----------
    row : (r,) array
        Displacement of the place that it hangs from, in the coordinates of the reduced basis [kg^-1/2].
    mass, stiffness, damping : float
        Of the mass [kg], the spring [N/m] and the dashpot [N s/m].
    """

    row: FloatArray
    mass: float
    stiffness: float
    damping: float

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


def motions(vectors: FloatArray, absorbers: Sequence[Absorber]) -> tuple[FloatArray, FloatArray]:
    """Return how the masses move in modes (n + k, m), and how they move against their places, each (k, m)."""
    n = len(vectors) - len(absorbers)
    own = vectors[n:]
    rows = np.array([one.row[:n] for one in absorbers]).reshape(len(absorbers), n)
    return own, own - rows @ vectors[:n]


def energies(vectors: FloatArray, absorbers: Sequence[Absorber]) -> dict[Kind, FloatArray]:
    """Return what absorbers add to phi^T K phi, phi^T M phi and phi^T C phi of modes (n + k, m), each (m,) [SI]."""
    own, against = motions(vectors, absorbers)
    parts: dict[Kind, FloatArray] = {"stiffness": against, "mass": own, "damping": against}
    sizes = {kind: np.array([one.size(kind) for one in absorbers]) for kind in parts}
    return {kind: np.asarray(sizes[kind] @ part**2) for kind, part in parts.items()}


@dataclass(frozen=True, eq=False)
class Damped:
    """Modes that dashpots of absorbers couple.

    Parameters
    ----------
    slowing : (m,) array
        Frequency, the modulus of the pole, over that of the undamped mode of the same rank [-].
    ratio : (m,) array
        Damping ratio [-].
    turn : (all, m) complex array
        The modes as combinations of the undamped ones: times phi_seen phi_hit they give modal constants.
    """

    slowing: FloatArray
    ratio: FloatArray
    turn: ComplexArray


def modes_taking_part(values: FloatArray, count: int) -> int:
    """Return how many of the undamped modes with eigenvalues (n,) take part where ``count`` are asked for."""
    return min(count + CLEAR, len(values))


def damped(values: FloatArray, viscous: FloatArray, count: int) -> Damped:
    """Solve for the damped modes where dashpots of absorbers couple undamped ones.

    A mode that is split in two by an absorber whose dashpot takes as much as the spring gives is near to no undamped
    one: the pencil of s^2 + s C + lambda is solved between the modes asked for and some above.

    Parameters
    ----------
    values : (all,) array
        Eigenvalues of the undamped elastic modes, rising [rad^2/s^2].
    viscous : (n, n) array
        C between the lowest n of them, of all that damps [1/s].
    count : int
        Number of modes asked for.

    Returns
    -------
    Damped
    """
    n = len(viscous)
    omega = np.sqrt(np.maximum(values[:n], 1e-12))
    system = np.block([[np.zeros((n, n)), np.diag(omega)], [-np.diag(omega), -viscous]])
    poles, states = np.linalg.eig(system)
    up = np.flatnonzero(poles.imag > 0)
    up = up[np.argsort(np.abs(poles[up]))]
    # a mode that creeps back without a swing has none: those that swing take the lowest ranks
    up = np.concatenate([up, np.repeat(up[-1:], n - len(up))])[:count]
    poles, shapes = poles[up], states[:n, up] / omega[:, None]
    # psi^T (2 p M + C) psi = 1 makes psi psi^T the residue, and 2 i Im p times that is the modal constant
    norm = 2 * poles * np.sum(shapes**2, axis=0) + np.einsum("ir,ij,jr->r", shapes, viscous, shapes)
    turn = np.zeros((len(values), len(up)), dtype=complex)
    turn[:n] = shapes * np.sqrt(2j * poles.imag / norm)
    size = np.abs(poles)
    return Damped(size / omega[:count], -poles.real / size, turn)
