"""Quintic elements on an uneven grid of lines: where nodes and Gauss points are, and how fields are read there.

Deflection and both rotations are independent tensor products of Lagrange polynomials on Gauss-Lobatto points.
A plate whose clamped line is not square is the image of the grid under x = x1 - (x1 - X) s(y), s linear in y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse

from acquisition.arrays import FloatArray, IntArray
from modalkit.simulator.bodies.element import NODES, ORDER, element_nodes, lagrange

GAUSS_COUNT = 7
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(GAUSS_COUNT)


def gauss_line(edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Gauss points and weights on the stretches between edges, shape (n_stretches, 7) [m]."""
    size = np.diff(edges)[:, None]
    return edges[:-1, None] + size * 0.5 * (1 + _POINTS), 0.5 * size * _WEIGHTS


@dataclass(frozen=True, eq=False)
class Reading:
    """Values of the shape functions at some places.

    Parameters
    ----------
    nodes : (n, 36) int array
        Nodes that count at each place.
    value, dx, dy : (n, 36) arrays
        Shape functions [-] and their derivatives in x and y [1/m].
    """

    nodes: IntArray
    value: FloatArray
    dx: FloatArray
    dy: FloatArray

    def rows(self, parts: dict[int, FloatArray], count: int) -> scipy.sparse.csr_array:
        """Return sparse rows that read a quantity.

        Parameters
        ----------
        parts : dict
            Of field (0 w, 1 rotation along x, 2 along y): factors of its nodes' values, (n, 36) arrays.
        count : int
            Number of DOFs: three a node, and others [-].

        Returns
        -------
        (n, count) sparse array
            Rows to multiply with a vector of DOFs.
        """
        columns = np.concatenate([3 * self.nodes + field for field in parts], axis=1)
        data = np.concatenate(list(parts.values()), axis=1)
        start = np.arange(len(columns) + 1) * columns.shape[1]
        return scipy.sparse.csr_array((data.ravel(), columns.ravel(), start), shape=(len(columns), count))


@dataclass(frozen=True, eq=False)
class Grid:
    """An uneven grid over a plate, or over its image.

    Parameters
    ----------
    x, y : (n + 1,) arrays
        Lines between the elements [m].
    slant : float
        Tangent of the angle between the line at x0 and the y axis, positive where it runs towards +x [-].
    """

    x: FloatArray
    y: FloatArray
    slant: float = 0.0

    @cached_property
    def shape(self) -> tuple[int, int]:
        """Number of nodes along x and y [-]."""
        return ORDER * (len(self.x) - 1) + 1, ORDER * (len(self.y) - 1) + 1

    @property
    def count(self) -> int:
        """Number of nodes; those along y follow each other [-]."""
        return self.shape[0] * self.shape[1]

    def stretch(self, y: FloatArray) -> FloatArray:
        """Return s(y), the length at y over the length in the middle [-]."""
        return np.asarray(1.0 + self._rate * (y - 0.5 * (self.y[0] + self.y[-1])))

    @property
    def _rate(self) -> float:
        return float(-self.slant / (self.x[-1] - self.x[0]))

    @cached_property
    def nodes(self) -> tuple[FloatArray, FloatArray]:
        """Grid positions of the nodes, shape (n_nodes,) each; not yet slanted [m]."""
        x, y = np.meshgrid(element_nodes(self.x), element_nodes(self.y), indexing="ij")
        return x.ravel(), y.ravel()

    def place(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return where a point of the grid lies on the plate, along x [m]."""
        return np.asarray(self.x[-1] - (self.x[-1] - x) * self.stretch(y))

    def find(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the grid position X of a place on the plate [m]."""
        return np.asarray(self.x[-1] - (self.x[-1] - x) / self.stretch(y))

    def read(self, grid_x: FloatArray, y: FloatArray) -> Reading:
        """Return shape functions and their derivatives on the plate at points of the grid.

        Parameters
        ----------
        grid_x, y : (n,) arrays
            Positions in the grid; what lies off it is read at its edge [m].

        Returns
        -------
        Reading
            At the n points.
        """
        grid_x, y = np.clip(grid_x, self.x[0], self.x[-1]), np.clip(y, self.y[0], self.y[-1])
        first_x, along, along_slope = _line(self.x, grid_x)
        first_y, across, across_slope = _line(self.y, y)
        own = np.arange(NODES)
        nodes = (first_x[:, None] + own)[:, :, None] * self.shape[1] + (first_y[:, None] + own)[:, None, :]
        value = _product(along, across)
        slope_x, slope_y = _product(along_slope, across), _product(along, across_slope)
        stretch = self.stretch(y)[:, None]
        shift = (self.x[-1] - grid_x)[:, None] * self._rate / stretch
        return Reading(nodes.reshape(len(y), -1), value, slope_x / stretch, slope_y + shift * slope_x)

    @cached_property
    def gauss(self) -> tuple[FloatArray, FloatArray, FloatArray, Reading]:
        """Gauss points: grid positions, weights [m2] and readings, 49 to an element, elements along y first."""
        (x, wx), (y, wy) = gauss_line(self.x), gauss_line(self.y)
        order = (0, 2, 1, 3)
        ones_x, ones_y = np.ones_like(x), np.ones_like(y)
        grid_x = np.einsum("ia,jb->iajb", x, ones_y).transpose(order).ravel()
        grid_y = np.einsum("ia,jb->iajb", ones_x, y).transpose(order).ravel()
        weight = np.einsum("ia,jb->iajb", wx, wy).transpose(order).ravel() * self.stretch(grid_y)
        return grid_x, grid_y, weight, self.read(grid_x, grid_y)


def _line(edges: FloatArray, x: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return first node, values and slopes of the polynomials of each place's element along one axis."""
    element = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    size = np.diff(edges)[element]
    values, slopes = lagrange((x - edges[element]) / size)
    return ORDER * element, values, slopes / size[:, None]


def _product(along: FloatArray, across: FloatArray) -> FloatArray:
    product: FloatArray = (along[:, :, None] * across[:, None, :]).reshape(len(along), -1)
    return product
