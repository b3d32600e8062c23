"""The potential flow round a thin flat plate, by a lattice of vortex rings.

A panel across which the potential jumps by a constant is a ring of straight vortices, whose velocity is that of Biot
and Savart (Katz and Plotkin, Low-Speed Aerodynamics, 2nd ed., 2001, section 10.4). Edges of panels and points of
collocation lie evenly in the angle of the cosine, which makes a strip exact (Lan, J. Aircraft 11 (1974) 518). Rigid
walls, a bottom and a free surface are made by mirrored lattices: a wall, and a surface that lies parallel to the
plate, mirror a panel with its own strength, a bottom and a surface upright to the plate with the opposite one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FAR = np.inf
MOST = 4
"""Mirrored tanks on either side; what lies beyond is taken for an even sheet."""


@dataclass(frozen=True)
class Water:
    """What bounds the water.

    Parameters
    ----------
    surface, bottom : float
        Distances of a free surface above and of a bottom below the plate, infinite where there are none [m].
    walls : tuple of four floats
        Rigid walls x0, x1, y0, y1; infinite where there are none; one at an edge lets no water round it [m].
    upright : float
        Where a free surface crosses the plane of the plate, at this y; infinite where it does not [m].
    """

    surface: float = FAR
    bottom: float = FAR
    walls: tuple[float, float, float, float] = (-FAR, FAR, -FAR, FAR)
    upright: float = FAR


@dataclass(frozen=True, eq=False)
class Lattice:
    """Panels.

    Parameters
    ----------
    points : (n, 2) array
        Where the velocity is that of the plate [m].
    corners : (n, 4, 2) array
        In the order of the ring [m].
    """

    points: Array
    corners: Array

    @property
    def areas(self) -> Array:
        """Areas of the panels, (n,) [m^2]."""
        one, two = self.corners[:, 2] - self.corners[:, 0], self.corners[:, 3] - self.corners[:, 1]
        return np.asarray(0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]))

    def added_mass(self, shapes: Callable[[Array], Array], water: Water | None = None) -> Array:
        """Return the added mass of some shapes for unit density, (m, m) [m^3]; ``shapes`` takes points, (n, 2)."""
        around = Water() if water is None else water
        moved = shapes(self.points)
        jump = np.linalg.solve(_influence(self, around), moved)
        found = moved.T @ (self.areas[:, None] * jump)
        return np.asarray(0.5 * (found + found.T))


def _cosines(side: float, count: int, *, wall: bool, even: bool = False) -> tuple[Array, Array]:
    """Return edges and points along a side of which the low end is a free edge, or a wall [m]."""
    edges, points = np.arange(count + 1) / count, (np.arange(count) + 0.5) / count
    if even:
        return side * edges, side * points
    if wall:
        return side * np.sin(0.5 * np.pi * edges), side * np.sin(0.5 * np.pi * points)
    return 0.5 * side * (1 - np.cos(np.pi * edges)), 0.5 * side * (1 - np.cos(np.pi * points))


def rectangle(
    length: float, width: float, along: int, across: int, *, wall: bool = False, even: bool = False
) -> Lattice:
    """Return a lattice on x in [0, length], y in [0, width], ``wall`` where the edge x = 0 touches one.

    ``even`` panels, whose points lie in their middles, converge slowly, from above.
    """
    ex, x = _cosines(length, along, wall=wall, even=even)
    ey, y = _cosines(width, across, wall=False, even=even)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    nodes = np.stack(np.meshgrid(ex, ey, indexing="ij"), axis=-1)
    return Lattice(points, _cells(nodes))


def disc(radius: float, rings: int, sectors: int) -> Lattice:
    """Return a lattice on a disc, whose polygon has the disc's area."""
    edges, points = _cosines(radius, rings, wall=True)
    angle = 2 * np.pi * np.arange(sectors + 1) / sectors
    larger = np.sqrt((angle[1]) / np.sin(angle[1]))
    nodes = larger * edges[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    middle = angle[:-1] + 0.5 * angle[1]
    places = points[:, None, None] * np.stack([np.cos(middle), np.sin(middle)], axis=-1)
    return Lattice(places.reshape(-1, 2), _cells(nodes))


def _cells(nodes: Array) -> Array:
    corners = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]], axis=2)
    return np.asarray(corners.reshape(-1, 4, 2))


def ring_velocity(points: Array, corners: Array, height: float) -> Array:
    """Return the velocity that rings of unit strength induce across their plane, (n, n) [1/m]."""
    total = np.zeros((len(points), len(corners)))
    for k in range(4):
        start, end = corners[:, k], corners[:, (k + 1) % 4]
        side = end - start
        first, second = points[:, None] - start, points[:, None] - end
        moment = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        square = moment**2 + height**2 * np.sum(side**2, axis=-1)
        lengths = (np.sqrt(np.sum(v**2, axis=-1) + height**2) for v in (first, second))
        one, two = (
            np.sum(v * side, axis=-1) / size for v, size in zip((first, second), lengths, strict=True)
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            total += np.where(square > 0, moment * (one - two) / square, 0.0)
    return total / (4 * np.pi)


def _doublet_velocity(points: Array, lattice: Lattice, height: float) -> Array:
    """Return the same of panels far away, as point doublets [1/m]."""
    apart = points[:, None] - lattice.corners.mean(axis=1)
    square = np.sum(apart**2, axis=-1) + height**2
    return np.asarray(-lattice.areas * (1 - 3 * height**2 / square) / square**1.5 / (4 * np.pi))


def _planes(water: Water) -> list[tuple[float, float]]:
    """Return heights and strengths of the lattice and those mirrored in surface and bottom."""
    up, down = bool(np.isfinite(water.surface)), bool(np.isfinite(water.bottom))
    if not (up and down):
        return [(0.0, 1.0)] + [(2 * water.surface, 1.0)] * up + [(-2 * water.bottom, -1.0)] * down
    depth = water.surface + water.bottom
    many = range(-3 * MOST, 3 * MOST + 1)
    pairs = [((2 * n * depth, (-1.0) ** n), (2 * water.surface + 2 * n * depth, (-1.0) ** n)) for n in many]
    return [plane for pair in pairs for plane in pair]


def _mirrors(low: float, high: float) -> list[tuple[float, float]]:
    """Return signs and shifts that take a coordinate to where the walls mirror it."""
    if np.isfinite(low) and np.isfinite(high):
        whole = 2 * (high - low)
        return [m for n in range(-MOST, MOST + 1) for m in ((1.0, n * whole), (-1.0, 2 * low + n * whole))]
    near = [(-1.0, 2 * wall) for wall in (low, high) if np.isfinite(wall)]
    return [(1.0, 0.0), *near]


def _influence(lattice: Lattice, water: Water) -> Array:
    """Return the velocity at the points by panels of unit jump, with all that is mirrored, (n, n) [1/m]."""
    x0, x1, y0, y1 = water.walls
    across = [(*mirror, 1.0) for mirror in _mirrors(y0, y1)]
    if np.isfinite(water.upright):
        across += [(-s, 2 * water.upright - t, -strength) for s, t, strength in across]
    size = np.ptp(lattice.corners.reshape(-1, 2), axis=0).max()
    total = np.zeros((len(lattice.points),) * 2)
    for (height, strength), (sx, tx), (sy, ty, share) in product(_planes(water), _mirrors(x0, x1), across):
        places = np.array([sx, sy]) * (lattice.points - [tx, ty])
        far = np.hypot(np.hypot(tx, ty), height) > 6 * size
        found = (
            _doublet_velocity(places, lattice, height)
            if far
            else ring_velocity(places, lattice.corners, height)
        )
        total += strength * share * found
    return total + _beyond(lattice, water)


def _beyond(lattice: Lattice, water: Water) -> Array:
    """Return what tanks beyond the last that are mirrored add, as an even sheet with a rectangular hole [1/m].

    Without surface and bottom: with either, they cancel.
    """
    x0, x1, y0, y1 = water.walls
    closed = np.isfinite([x0, x1, y0, y1]).all() and not np.isfinite([water.surface, water.bottom]).any()
    if not closed:
        return np.zeros((len(lattice.points),) * 2)
    a, b = (2 * MOST + 1) * (x1 - x0), (2 * MOST + 1) * (y1 - y0)
    per_area = lattice.areas / ((x1 - x0) * (y1 - y0))
    outside = -4 * np.hypot(a, b) / (a * b) / (4 * np.pi)  # of a hole of half-sides a and b
    return np.asarray(np.tile(outside * per_area, (len(lattice.points), 1)))


def limit(coarse: Array, middle: Array, fine: Array) -> Array:
    """Return what three lattices, each twice as fine as the last, tend to.

    Errors of first and second order drop out.
    """
    one, two = 2 * middle - coarse, 2 * fine - middle
    return np.asarray((4 * two - one) / 3)
