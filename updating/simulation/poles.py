"""All damped modes of a model, the ones that do not oscillate included: what a sum over modes needs to be exact.

Foss (1958) for viscous damping that couples the modes; closed form where it does not, however close the modes are.
"""

from __future__ import annotations

import numpy as np
from scipy import linalg

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import StudyError
from updating.models.complex_modes import ComplexModes
from updating.models.damping import Matrices
from updating.simulation.model import Simulated

UNCOUPLED = 1e-10
"""Coupling of two modes by the damping below which there is none, relative to their own damping [-]."""


def damped_modes(model: Simulated) -> ComplexModes:
    """Solve for all modes; H(s) = sum_r psi psi^T / (s - p) + conj(psi psi^T) / (s - conj p).

    A real pole stands with half its residue, so that both terms together make it whole.

    Parameters
    ----------
    model : Simulated
        A clamped or hung structure.

    Raises
    ------
    StudyError
        If the structure is free: its rigid-body modes have no such residues.
    """
    if model.rigid:
        raise StudyError(
            "a free structure drifts away: hang it on soft cords first, with Simulated.hung() in Python"
        )
    values, vectors = linalg.eigh(model.matrices.stiffness, model.matrices.mass)
    if values[0] <= 0:
        raise StudyError("the model has no stiffness left in this state: an effect removed too much")
    viscous, structural = modal_damping(model.matrices, vectors)
    if uncoupled(viscous) and uncoupled(structural):
        return _alone(vectors, values + 1j * np.diag(structural), np.diag(viscous))
    return _coupled(vectors, values, viscous, structural)


def modal_damping(matrices: Matrices, vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return C and D between undamped modes, each (n_modes, n_modes) [1/s, 1/s^2]."""
    return vectors.T @ matrices.viscous @ vectors, vectors.T @ matrices.structural @ vectors


def uncoupled(damping: FloatArray) -> bool:
    """Return whether damping leaves the undamped modes alone."""
    own = np.sqrt(np.abs(np.diag(damping)))
    scale = np.outer(own, own) + UNCOUPLED * np.abs(damping).max(initial=0.0)
    off = np.abs(damping - np.diag(np.diag(damping)))
    return bool(np.all(off <= np.sqrt(UNCOUPLED) * scale))


def _alone(vectors: FloatArray, stiffness: ComplexArray, viscous: FloatArray) -> ComplexModes:
    """Solve s^2 + c s + k = 0 for every mode by itself."""
    root = np.sqrt(viscous**2 / 4 - stiffness + 0j)
    root = np.where(root.imag < 0, -root, root)
    creeping = (root.imag == 0) | ((stiffness.imag == 0) & (viscous**2 / 4 > stiffness.real))
    poles = np.concatenate([-viscous / 2 + root, (-viscous / 2 - root)[creeping]])
    residues = np.concatenate([1 / (2 * root), -1 / (2 * root[creeping])])
    share = np.concatenate([np.where(creeping, 0.5, 1.0), np.full(int(creeping.sum()), 0.5)])
    shapes = np.hstack([vectors, vectors[:, creeping]]) * np.sqrt(share * residues)
    return _sorted(poles, shapes)


def _coupled(
    vectors: FloatArray, values: FloatArray, viscous: FloatArray, structural: FloatArray
) -> ComplexModes:
    """Solve the pencil of the state (omega q, dq/dt), whose entries are of one size, in the undamped modes."""
    omega = np.diag(np.sqrt(values))
    held = omega + 1j * structural / np.sqrt(values) if np.any(structural) else omega
    poles, states = linalg.eig(np.block([[np.zeros_like(omega), omega], [-held, -viscous]]))
    keep = poles.imag >= 0
    if np.any(structural):
        keep = poles.imag > 0
    poles, shapes = poles[keep].astype(complex), states[: len(values), keep] / np.sqrt(values)[:, None]
    # psi^T (2 p M + C) psi = 1 makes psi psi^T the residue
    norm = 2 * poles * np.sum(shapes**2, axis=0) + np.einsum("ir,ij,jr->r", shapes, viscous, shapes)
    share = np.where(poles.imag > 0, 1.0, 0.5)
    return _sorted(poles, vectors @ (shapes * np.sqrt(share / norm)))


def _sorted(poles: ComplexArray, vectors: ComplexArray) -> ComplexModes:
    order = np.argsort(np.abs(poles), kind="stable")
    return ComplexModes(poles[order], vectors[:, order])
