"""Complex modes of a model whose damping is not proportional.

The symmetric state-space pencil of s^2 M + s C + K + i D (Foss 1958; with structural damping, Ewins, Modal
Testing, 2000, section 2.7) in the coordinates of the undamped modes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from acquisition.arrays import ComplexArray
from updating.models.damping import Matrices


@dataclass(frozen=True, eq=False)
class ComplexModes:
    """Poles and shapes: H(s) = sum_r psi_r psi_r^T / (s - p_r) + conj(psi_r psi_r^T) / (s - conj p_r).

    So with viscous damping. With structural damping that couples modes the poles and residues are those of the upper
    half plane, and the sum is the FRF near resonances only.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles with positive imaginary part, by frequency [rad/s].
    vectors : (r, n_modes) complex array
        Shapes psi on the reduced basis, scaled so that psi psi^T is the residue.
    """

    poles: ComplexArray
    vectors: ComplexArray


def complex_modes(matrices: Matrices, *, rigid: int = 0) -> ComplexModes:
    """Solve for the damped modes.

    Parameters
    ----------
    matrices : Matrices
        K, M, C and D.
    rigid : int
        Number of rigid-body modes, which are left out.

    Returns
    -------
    ComplexModes
        All elastic modes of the reduced model that oscillate.
    """
    values, vectors = matrices.undamped
    viscous, structural = matrices.in_modes
    n = len(values)
    # a rigid body has no stiffness; rounding must not give it one of its own
    spring = np.diag(np.where(np.arange(n) < rigid, 0.0, values)).astype(complex) + 1j * structural
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-spring, -viscous]])
    poles, states = linalg.eig(system)
    least = 0.05 * np.sqrt(max(values[rigid], 0.0))
    keep = np.flatnonzero(poles.imag > least)
    keep = keep[np.argsort(poles.imag[keep])]
    poles, shapes = poles[keep], states[:n, keep]
    # psi^T (2 p M + C) psi = 1 makes psi psi^T the residue
    norm = 2 * poles * np.sum(shapes**2, axis=0) + np.einsum("ir,ij,jr->r", shapes, viscous, shapes)
    return ComplexModes(poles, vectors @ (shapes / np.sqrt(norm)))
