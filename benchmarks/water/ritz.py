"""A thin elastic plate by Ritz's method with Legendre polynomials, dry and in water.

Kirchhoff's energies, integrated by Gauss's rule; an edge is clamped by springs, which may be compliant. Nothing of it
is shared with the library's elements (Leissa, Vibration of Plates, NASA SP-160, 1969, for the energies).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]
STIFF = 1e8
"""Springs of an ideal clamp over the plate's own stiffness [-]."""


@dataclass(frozen=True)
class Plate:
    """A plate x in [0, length], y in [0, width].

    Parameters
    ----------
    length, width, thickness : float
        [m].
    E, density, poisson : float
        [Pa, kg/m^3, -].
    clamped : bool
        Whether the edge x = 0 is held; if not, the plate is free.
    rotation : float
        Rotational stiffness of the clamp per metre of edge; infinite is ideal [N].
    orders : (int, int)
        Polynomials along and across.
    sensor : tuple of three floats
        Place and mass of a sensor [m, m, kg].
    """

    length: float
    width: float
    thickness: float
    E: float = 210e9
    density: float = 7850.0
    poisson: float = 0.3
    clamped: bool = True
    rotation: float = np.inf
    orders: tuple[int, int] = (14, 10)
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def rigid(self) -> int:
        """Modes of no frequency."""
        return 0 if self.clamped else 3

    def basis(self, points: Array, along: int = 0, across: int = 0) -> Array:
        """Return the polynomials, or derivatives, at points, (n, p)."""
        x = _polynomials(points[:, 0], self.length, self.orders[0], along)
        y = _polynomials(points[:, 1], self.width, self.orders[1], across)
        return np.asarray(np.einsum("ni,nj->nij", x, y).reshape(len(points), -1))

    @cached_property
    def matrices(self) -> tuple[Array, Array]:
        """Stiffness and mass between the polynomials."""
        points, weight = _gauss(self.length, self.width, max(self.orders) + 2)
        rigidity = self.E * self.thickness**3 / 12 / (1 - self.poisson**2)
        xx, yy, xy, w = (self.basis(points, *d) for d in ((2, 0), (0, 2), (1, 1), (0, 0)))
        total = xx + yy
        stiffness = rigidity * (total.T @ (weight[:, None] * total))
        for one, two, factor in ((xx, yy, -0.5), (yy, xx, -0.5), (xy, xy, 1.0)):
            stiffness += 2 * (1 - self.poisson) * factor * rigidity * (one.T @ (weight[:, None] * two))
        mass = self.density * self.thickness * (w.T @ (weight[:, None] * w))
        if self.sensor[2]:
            at = self.basis(np.array([self.sensor[:2]]))
            mass = mass + self.sensor[2] * at.T @ at
        return stiffness + self._springs(rigidity), mass

    def _springs(self, rigidity: float) -> Array:
        count = self.orders[0] * self.orders[1]
        if not self.clamped:
            return np.zeros((count, count))
        node, weight = legendre.leggauss(self.orders[1] + 2)
        edge = np.stack([np.zeros(len(node)), 0.5 * self.width * (node + 1)], axis=1)
        turn = STIFF * rigidity / self.length if np.isinf(self.rotation) else self.rotation
        found = np.zeros((count, count))
        for order, spring in ((0, STIFF * rigidity / self.length**3), (1, turn)):
            rows = self.basis(edge, order, 0)
            found += spring * rows.T @ (0.5 * self.width * weight[:, None] * rows)
        return found

    def modes(self, count: int) -> tuple[Array, Array]:
        """Return frequencies [Hz] and coefficients of the elastic modes, of unit modal mass."""
        squared, vectors = eigh(*self.matrices)
        kept = slice(self.rigid, self.rigid + count)
        return np.sqrt(squared[kept]) / (2 * np.pi), vectors[:, kept]

    def wet_modes(self, count: int, added: Array, dry: Array) -> tuple[Array, Array]:
        """Return the same in water whose inertia between the coefficients ``dry`` is ``added`` [kg]."""
        squared = np.diag(dry.T @ self.matrices[0] @ dry)
        found, mixed = eigh(np.diag(squared), np.eye(len(squared)) + added)
        kept = slice(self.rigid, self.rigid + count)
        return np.sqrt(np.maximum(found[kept], 0)) / (2 * np.pi), dry @ mixed[:, kept]

    def all_modes(self, count: int) -> Array:
        """Return coefficients of the lowest modes, those of no frequency among them."""
        return np.asarray(eigh(*self.matrices, subset_by_index=(0, count - 1))[1])


def _polynomials(x: Array, side: float, count: int, order: int) -> Array:
    rows = [legendre.legval(2 * x / side - 1, legendre.legder(np.eye(count)[i], order)) for i in range(count)]
    return np.asarray(np.stack(rows, axis=1) * (2 / side) ** order)


def _gauss(length: float, width: float, count: int) -> tuple[Array, Array]:
    node, weight = legendre.leggauss(count)
    x, y = np.meshgrid(0.5 * length * (node + 1), 0.5 * width * (node + 1), indexing="ij")
    whole = 0.25 * length * width * np.outer(weight, weight)
    return np.stack([x.ravel(), y.ravel()], axis=1), whole.ravel()
