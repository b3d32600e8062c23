"""Damped modes: each pole by inverse iteration on the full symmetric pencil, whatever its frequency dependence.

Z(s) = s^2 I + s C(omega) + Omega^2 + i D, with C = C0 + sqrt(omega) C1 frozen at the mode's own frequency; the pole
follows from the symmetric Rayleigh functional x^T Z(s) x = 0, the residue is x x^T / (x^T Z'(s) x).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.mesh import Floats

Complexes = NDArray[np.complex128]
ROUNDS = 8


@dataclass(frozen=True, eq=False)
class Damped:
    """Poles [rad/s], and shapes in modal coordinates, whose products are modal constants [1/kg]."""

    poles: Complexes
    shapes: Complexes


def damped(omega: Floats, viscous: Floats, losses: Floats, drag: Floats, count: int) -> Damped:
    """Return the lowest damped modes.

    Parameters
    ----------
    omega : (m,) array
        Frequencies without damping [rad/s].
    viscous, losses, drag : (m, m) arrays
        C0, D and C1 in modal coordinates.
    count : int
        How many modes.
    """
    poles, shapes = [], []
    size = len(omega)
    for r in range(count):
        c = viscous + np.sqrt(omega[r]) * drag
        spring = np.diag(omega**2).astype(complex) + 1j * losses
        x = np.zeros(size, complex)
        x[r] = 1.0
        s = 1j * omega[r] - c[r, r] / 2 - losses[r, r] / (2 * omega[r])
        for _ in range(ROUNDS):
            x = np.linalg.solve(s**2 * np.eye(size) + s * c + spring, (2 * s * x + c @ x))
            x = x / np.sqrt(x @ x)
            b, k = x @ c @ x, x @ spring @ x
            new = (-b + np.sqrt(b * b - 4 * k)) / 2
            new = new if new.imag > 0 else (-b - np.sqrt(b * b - 4 * k)) / 2
            done = abs(new - s) < 1e-10 * abs(s)
            s = new
            if done:
                break
        poles.append(s)
        shapes.append(x * np.sqrt(2j * s.imag / (2 * s + x @ c @ x)))
    return Damped(np.array(poles), np.array(shapes).T)
