"""A structure with an absorber on it: a mode of 1 to 5 % beside sharp ones, its shape that of its neighbour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.synthetic import ModalSystem
from hammer.plain import beam_test
from hammer.setups import Setup

MASS, DAMPING, TUNED = (0.005, 0.05), (0.01, 0.05), (0.85, 1.15)
"""Mass over the modal mass, damping ratio, and frequency over that of the mode it is tuned to [-]."""


def absorber_test(rng: np.random.Generator) -> Setup:
    """Draw a beam with an absorber on it."""
    setup = beam_test(rng)
    return replace(setup, system=absorbed(setup.system, setup.band, rng))


def absorbed(system: ModalSystem, band: tuple[float, float], rng: np.random.Generator) -> ModalSystem:
    """Return a system of real modes with an absorber at one of the points hit, tuned near a mode of the band.

    The damped modes of the whole, modal coordinates and the absorber's, are those of the first-order equations; each
    residue is psi_i psi_j / (psi^T (2 lambda M + C) psi) (Ewins, Modal Testing, 2nd ed., Sec. 2.7).

    Parameters
    ----------
    system : ModalSystem
        The structure alone, real shapes.
    band : tuple of float
        Band of the test [Hz].
    rng : numpy.random.Generator
        Source of the draw.
    """
    omega = np.abs(system.poles)
    ratio = -system.poles.real / omega
    inside = np.flatnonzero((omega > 2 * np.pi * 2 * band[0]) & (omega < 2 * np.pi * 0.9 * band[1]))
    target = int(rng.choice(inside))
    product = (system.residues * 2j * system.poles.imag).real
    strong = np.flatnonzero(np.abs(product[0, :, target]) > 0.5 * np.abs(product[0, :, target]).max())
    seat = int(rng.choice(strong))
    drive = _shape_of_drive(product, seat)
    mass = rng.uniform(*MASS) / drive[target] ** 2
    tuned, damping = omega[target] * rng.uniform(*TUNED), rng.uniform(*DAMPING)
    link = np.append(drive, -1.0)
    m = np.diag(np.append(np.ones(len(omega)), mass))
    k = np.diag(np.append(omega**2, 0.0)) + mass * tuned**2 * np.outer(link, link)
    c = np.diag(np.append(2 * ratio * omega, 0.0)) + 2 * damping * mass * tuned * np.outer(link, link)
    poles, shapes = _damped_modes(m, c, k)
    own = shapes[: len(omega)]
    # in terms of the plain modes: product_ij,r = phi_i phi_j; phi_i of a mode is product_i,seat over drive
    at_points, at_seats = product[0] / _at_sensor(product, drive, seat), product[:, seat] / drive
    responses, points = at_seats @ own, at_points @ own
    slopes = None
    if system.gradients is not None:
        plain = (system.gradients * 2j * system.poles.imag).real
        tilted = plain[:, 0] / _at_sensor(product, drive, seat)
        slopes = np.einsum("im,ajm->aijm", responses, tilted @ own)
    return replace(system, poles=poles, residues=np.einsum("im,jm->ijm", responses, points), gradients=slopes)


def _shape_of_drive(product: np.ndarray, seat: int) -> np.ndarray:
    """Return the shapes at the absorber, of one sign each: it sits where the sensor may not, so its size is free."""
    return np.sqrt(np.abs(product[0, seat]))


def _at_sensor(product: np.ndarray, drive: np.ndarray, seat: int) -> np.ndarray:
    """Return the shapes at the first sensor that go with those at the absorber."""
    return np.asarray(product[0, seat] / drive)


def _damped_modes(m: np.ndarray, c: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return poles above the real axis and shapes scaled so that a residue is the product of two components."""
    n = len(m)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    poles, vectors = np.linalg.eig(state)
    upper = np.flatnonzero(poles.imag > 0)
    upper = upper[np.argsort(np.abs(poles[upper]))]
    poles, shapes = poles[upper], vectors[:n, upper]
    unit = np.array([q @ (2 * p * m + c) @ q for p, q in zip(poles, shapes.T, strict=True)])
    return poles, shapes / np.sqrt(unit)
