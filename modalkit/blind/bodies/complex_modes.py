"""Poles and residues of a damped beam, exactly, from its real modes and its damping matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.blind.bodies.beam import Beam


@dataclass(frozen=True, eq=False)
class ComplexModes:
    """Complex modes of a beam, read at the test's points.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Upper poles, by frequency [1/s].
    points, slopes : (n_points, n_modes) complex arrays
        Shapes at the points, scaled so that the receptance residue is their product [m/sqrt(N s)], and their
        derivatives along the beam [1/sqrt(N s)].
    """

    poles: ComplexArray
    points: ComplexArray
    slopes: ComplexArray

    @property
    def frequency(self) -> FloatArray:
        """Undamped natural frequencies |pole| / 2 pi [Hz]."""
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping(self) -> FloatArray:
        """Damping ratios [-]."""
        return -self.poles.real / np.abs(self.poles)

    def residues(self, sensor: int) -> ComplexArray:
        """Return receptance residues between a sensor and each point, (1, n_points, n_modes) [m/(N s)]."""
        products: ComplexArray = (self.points[sensor] * self.points)[None]
        return products

    def gradients(self, sensor: int) -> ComplexArray:
        """Return how residues change when the hammer strays along the beam, as ``residues`` [1/(N s)]."""
        products: ComplexArray = (self.points[sensor] * self.slopes)[None]
        return products


def complex_modes(beam: Beam, places: FloatArray, *, count: int, scatter: FloatArray) -> ComplexModes:
    """Solve the quadratic eigenproblem of the beam in its own real modes.

    Parameters
    ----------
    beam : Beam
        The specimen.
    places : (n_points,) array
        Where the shapes are wanted [m].
    count : int
        Number of real modes taken [-].
    scatter : (count,) array
        Factor on each mode's material damping [-].

    Returns
    -------
    ComplexModes
        All underdamped modes: with state matrices A = [[C, I], [I, 0]], B = [[K, 0], [0, -I]] an eigenvector
        psi is scaled so that psi^T A psi = 1, and the residue is the product of its entries (Ewins, Modal
        Testing, 2nd ed., section 2.7).
    """
    omega, shapes = beam.real_modes(count)
    material, dashpots = beam.modal_damping(shapes)
    damping = np.sqrt(np.outer(scatter, scatter)) * material + dashpots
    eye, zero = np.eye(count), np.zeros((count, count))
    state = np.block([[zero, eye], [-np.diag(omega**2), -damping]])
    poles, vectors = scipy.linalg.eig(state)
    upper = np.flatnonzero(poles.imag > 1e-6 * np.abs(poles))
    upper = upper[np.argsort(poles[upper].imag)]
    poles, modal = poles[upper], vectors[:count, upper]
    scale = np.einsum("ir,ij,jr->r", modal, damping, modal) + 2 * poles * np.einsum("ir,ir->r", modal, modal)
    modal = modal / np.sqrt(scale)
    reader = beam.rows(places, "w") @ shapes, beam.rows(places, "slope") @ shapes
    return ComplexModes(poles=poles, points=reader[0] @ modal, slopes=reader[1] @ modal)
