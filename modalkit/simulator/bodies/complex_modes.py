"""Poles and residues of a damped body, exactly, from its real modes and its damping matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.simulator.bodies.body import Body


@dataclass(frozen=True, eq=False)
class ComplexModes:
    """Complex modes of a body, read where it is hit and where it is seen.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Upper poles, by frequency [1/s].
    points : (n_points, n_modes) complex array
        Shapes where the hammer hits, scaled so that the receptance residue is the product of the shapes at
        both ends [m/sqrt(N s)].
    slopes : (n_axes, n_points, n_modes) complex array
        Their derivatives along the in-plane axes [1/sqrt(N s)].
    sensor : (n_modes,) complex array
        Shapes at the sensor, as ``points`` [m/sqrt(N s)].
    """

    poles: ComplexArray
    points: ComplexArray
    slopes: ComplexArray
    sensor: ComplexArray

    @property
    def frequency(self) -> FloatArray:
        """Undamped natural frequencies |pole| / 2 pi [Hz]."""
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping(self) -> FloatArray:
        """Damping ratios [-]."""
        return -self.poles.real / np.abs(self.poles)

    @property
    def residues(self) -> ComplexArray:
        """Receptance residues between the sensor and each point, (n_points, n_modes) [m/(N s)]."""
        return self.points * self.sensor

    @property
    def gradients(self) -> ComplexArray:
        """How residues change when the hammer strays, (n_axes, n_points, n_modes) [1/(N s)]."""
        return self.slopes * self.sensor

    def take(self, chosen: slice) -> ComplexModes:
        """Return some of the modes."""
        return ComplexModes(
            self.poles[chosen], self.points[:, chosen], self.slopes[..., chosen], self.sensor[chosen]
        )


def complex_modes(
    body: Body, places: FloatArray, sensor: FloatArray, *, count: int, scatter: FloatArray
) -> ComplexModes:
    """Solve the quadratic eigenproblem of the body in its own real modes.

    Parameters
    ----------
    body : Body
        The specimen.
    places : (n_points, dim) array
        Where it is hit [m].
    sensor : (dim,) array
        Where it is seen [m].
    count : int
        Number of real modes taken [-].
    scatter : (count,) array
        Factor on each mode's material damping [-].

    Returns
    -------
    ComplexModes
        All underdamped modes: with state matrices A = [[C, M], [M, 0]], B = [[K, 0], [0, -M]] an eigenvector
        psi is scaled so that psi^T A psi = 1, and the residue is the product of its entries (Ewins, Modal
        Testing, 2nd ed., section 2.7). Damping by a law of its own is taken at the modes' frequencies.
    """
    omega, shapes = body.real_modes(count)
    material, others = body.modal_damping(shapes)
    damping, mass = np.sqrt(np.outer(scatter, scatter)) * material + others, np.eye(count)
    size = np.maximum(omega, 1e-3 * omega.max())
    for loss in body.modal_losses(shapes):
        viscous = loss.matrix * np.outer(size, size) ** (loss.power / 2)
        damping = damping + viscous
        if loss.inertia:
            mass = mass + viscous / np.sqrt(np.outer(size, size))
    poles, modal = _solve(mass, damping, omega)
    reader = body.rows(places, "w") @ shapes
    slopes = np.array([body.rows(places, name) @ shapes for name in body.gradients])
    seen = (body.rows(sensor[None], "w") @ shapes)[0]
    return ComplexModes(poles, points=reader @ modal, slopes=slopes @ modal, sensor=seen @ modal)


def _solve(mass: FloatArray, damping: FloatArray, omega: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return upper poles and scaled vectors of M q'' + C q' + diag(omega^2) q = 0."""
    count = len(omega)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((count, count)), np.eye(count)], [-inverse * omega**2, -inverse @ damping]])
    poles, vectors = scipy.linalg.eig(state)
    upper = np.flatnonzero(poles.imag > 1e-6 * np.abs(poles))
    upper = upper[np.argsort(poles[upper].imag)]
    poles, modal = poles[upper], vectors[:count, upper]
    scale = np.einsum("ir,ij,jr->r", modal, damping, modal)
    scale = scale + 2 * poles * np.einsum("ir,ij,jr->r", modal, mass, modal)
    return poles, modal / np.sqrt(scale)
