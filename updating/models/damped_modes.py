"""Modes that dampers couple: of absorbers' dashpots, and of close modes that what damps one place turns together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from updating.models.absorbers import structural
from updating.models.damping import STRUCTURAL, VISCOUS
from updating.models.state import State

CLEAR = 8
"""So many modes beyond those asked for take part where dashpots couple them: what lies further off is moved by the
square of its coupling over its distance [-]. Doubled: no pole moves by 1e-4 of its damping."""

TURNED = 0.03
"""Share of one mode in another [-] from which dampers of effects are taken to make modes of their own: phases change by
as much [rad], which is their doubt, and levels where a sensor sits near a node. Doubled, close modes on a damped
suspension are compared with phases that are wrong by twice that."""

BY_ROUNDING = 1e-10
"""Coupling of two modes over what damps either that is rounding [-]: of a pair at one frequency it would decide."""


@dataclass(frozen=True, eq=False)
class Damped:
    """Modes that dampers couple.

    Parameters
    ----------
    slowing : (m,) array
        Frequency, the modulus of the pole, over that of the undamped mode of the same rank [-].
    ratio : (m,) array
        Damping ratio [-].
    turn : (all, m) complex array
        The modes as combinations of the undamped ones: times phi_seen phi_hit they give modal constants.
    taking_part : int
        How many of the undamped ones, the lowest, were let couple.
    """

    slowing: FloatArray
    ratio: FloatArray
    turn: ComplexArray
    taking_part: int


def modes_taking_part(values: FloatArray, count: int) -> int:
    """Return how many of the undamped modes with eigenvalues (n,) take part where ``count`` are asked for."""
    return min(count + CLEAR, len(values))


def damped(values: FloatArray, viscous: FloatArray, count: int) -> Damped:
    """Solve for the damped modes where dampers couple undamped ones.

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
    n, viscous = len(viscous), _without_rounding(viscous)
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
    return Damped(size / omega[:count], -poles.real / size, turn, n)


def turns_modes(state: State, values: FloatArray, vectors: FloatArray) -> bool:
    """Return whether dampers of effects turn modes into each other by more than ``TURNED``.

    To first order mode k takes part in mode r with i omega_r C_kr / (omega_k^2 - omega_r^2): little unless they are
    close.

    Parameters
    ----------
    state : State
        Its losses.
    values : (n_modes,) array
        Eigenvalues of elastic modes [rad^2/s^2].
    vectors : (r, n_modes) array
        These modes, mass-normalised, absorbers behind the structure.
    """
    losses = [loss for loss in state.losses if loss.power in (VISCOUS, STRUCTURAL)]
    if not losses:
        return False
    vectors = structural(vectors, state.absorbers)
    n, omega = len(vectors), np.sqrt(np.maximum(values, 1e-12))
    middle = np.sqrt(np.outer(omega, omega))
    rates = sum(vectors.T @ loss.matrix[:n, :n] @ vectors * middle**loss.power for loss in losses)
    rates = _without_rounding(np.asarray(rates))
    gap = np.abs(values[:, None] - values)
    np.fill_diagonal(gap, np.inf)
    return bool((np.abs(rates) * omega > TURNED * gap).any())


def _without_rounding(coupling: FloatArray) -> FloatArray:
    """Return a matrix (n, n) without entries that are rounding beside its diagonal."""
    own = np.sqrt(np.abs(np.diag(coupling)))
    return np.where(np.abs(coupling) > BY_ROUNDING * np.outer(own, own), coupling, 0.0)
