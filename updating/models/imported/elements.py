"""A place in a finite element: which one holds it, and what its nodes' motions are worth there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.spatial import KDTree

from acquisition.arrays import FloatArray, IntArray

Powers = tuple[tuple[int, int, int], ...]

LINEAR, QUADRATIC = ((0,), (1,)), ((0,), (1,), (2,))

NEAREST = 4
"""Nearest nodes whose elements are tried for a place [-]: it lies in an element of its nearest node unless elements are
long and narrow."""

STEPS = 12
"""Steps of Newton to a place in an element [-]; it is found in three unless the element is badly bent."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The shape functions of a kind of element: monomials that are 1 at one node and 0 at all others.

    Parameters
    ----------
    nodes : (k, dim) array
        Natural coordinates of its nodes [-].
    powers : (k, dim) int array
        Exponents of its monomials.
    triangle : int
        How many of its first coordinates are those of a triangle or tetrahedron, from 0 to 1 with a sum below 1;
        all others run from -1 to 1.
    """

    nodes: FloatArray
    powers: IntArray
    triangle: int

    @cached_property
    def _inverse(self) -> FloatArray:
        return np.linalg.inv(np.prod(self.nodes[:, None, :] ** self.powers, axis=2))

    def values(self, at: FloatArray) -> FloatArray:
        """Return the shape functions at natural coordinates (dim,), shape (k,) [-]."""
        return np.asarray(np.prod(at**self.powers, axis=1) @ self._inverse)

    def slopes(self, at: FloatArray) -> FloatArray:
        """Return their derivatives by the natural coordinates, shape (dim, k) [-]."""
        rows = []
        for axis in range(self.nodes.shape[1]):
            lower = np.array(self.powers)
            lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
            rows.append(self.powers[:, axis] * np.prod(at**lower, axis=1) @ self._inverse)
        return np.array(rows)

    def inside(self, at: FloatArray) -> FloatArray:
        """Return the natural coordinates nearest to some that lie in the element."""
        kept = np.clip(at, -1.0, 1.0)
        corner = np.clip(at[: self.triangle], 0.0, None)
        kept[: self.triangle] = corner / max(float(corner.sum()), 1.0)
        return kept


@lru_cache(maxsize=32)
def shape_of(family: str, count: int) -> Shape | None:
    """Return the shape functions of solids (``C3D``), shells (``S``) and beams (``B``) by their number of nodes."""
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    corner = np.array([(0, 0), (1, 0), (0, 1)], dtype=float)
    made = {
        ("B", 2): (np.array([[-1.0], [1.0]]), [], LINEAR, 0),
        ("B", 3): (np.array([[-1.0], [0.0], [1.0]]), [], QUADRATIC, 0),
        ("S", 3): (corner, [], _upto(2, 1), 2),
        ("S", 6): (corner, [(0, 1), (1, 2), (2, 0)], _upto(2, 2), 2),
        ("S", 4): (square, [], _serendipity(2, 1), 0),
        ("S", 8): (square, [(0, 1), (1, 2), (2, 3), (3, 0)], _serendipity(2, 2), 0),
        ("C3D", 4): (_TETRAHEDRON, [], _upto(3, 1), 3),
        ("C3D", 10): (_TETRAHEDRON, [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], _upto(3, 2), 3),
        ("C3D", 8): (_raised(square), [], _serendipity(3, 1), 0),
        ("C3D", 20): (_raised(square), _around(4), _serendipity(3, 2), 0),
        ("C3D", 6): (_raised(corner), [], _wedge(1), 2),
        ("C3D", 15): (_raised(corner), _around(3), _wedge(2), 2),
    }.get((family, count))
    if made is None:
        return None
    corners, edges, powers, triangle = made
    middles = [(corners[a] + corners[b]) / 2 for a, b in edges]
    return Shape(np.vstack([corners, *middles]), np.array(powers, dtype=np.int64), triangle)


_TETRAHEDRON = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)


def _raised(base: FloatArray) -> FloatArray:
    """Return the corners of a prism over a base."""
    return np.vstack([np.column_stack([base, np.full(len(base), z)]) for z in (-1.0, 1.0)])


def _around(sides: int) -> list[tuple[int, int]]:
    """Return the edges of a prism: those of its base, of its top, and those that stand."""
    base = [(i, (i + 1) % sides) for i in range(sides)]
    return [*base, *((a + sides, b + sides) for a, b in base), *((i, i + sides) for i in range(sides))]


def _upto(dim: int, degree: int) -> list[tuple[int, ...]]:
    """Return the exponents of all monomials up to a degree."""
    return [p for p in np.ndindex(*[degree + 1] * dim) if sum(p) <= degree]


def _serendipity(dim: int, degree: int) -> list[tuple[int, ...]]:
    """Return the exponents of the elements without nodes on faces: at most one coordinate is squared."""
    return [p for p in np.ndindex(*[degree + 1] * dim) if sum(c == 2 for c in p) <= 1]


def _wedge(degree: int) -> list[tuple[int, ...]]:
    """Return the exponents of wedges: of a triangle along the base, of a line upwards, no higher than both allow."""
    flat = [(*p, z) for p in _upto(2, degree) for z in (0, 1)]
    return flat if degree == 1 else [*flat, *((*p, 2) for p in _upto(2, 1))]


@dataclass(frozen=True, eq=False)
class Held:
    """A place in an element.

    Parameters
    ----------
    nodes : (k,) int array
        Numbers of the element's nodes.
    weights : (k,) array
        Their shares in the motion at the place [-].
    slopes : (3, k) array
        Their shares in its derivatives along x, y and z, of shells and beams those along them alone [1/m].
    distance : float
        How far from the element the place lies; the shares are those of the element's point nearest to it [m].
    """

    nodes: IntArray
    weights: FloatArray
    slopes: FloatArray
    distance: float


@dataclass(frozen=True, eq=False)
class Elements:
    """The elements of a model.

    Parameters
    ----------
    at : mapping of int to (3,) array
        Coordinates of its nodes [m].
    members : tuple of (family, nodes)
        ``C3D``, ``S`` or ``B``, and the numbers of the element's nodes in CalculiX's order.
    """

    at: Mapping[int, FloatArray]
    members: tuple[tuple[str, tuple[int, ...]], ...]

    @cached_property
    def _of_node(self) -> dict[int, list[int]]:
        found: dict[int, list[int]] = {}
        for number, (_, nodes) in enumerate(self.members):
            for node in nodes:
                found.setdefault(node, []).append(number)
        return found

    @cached_property
    def _tree(self) -> tuple[IntArray, KDTree]:
        nodes = np.array(sorted(self._of_node), dtype=np.int64)
        return nodes, KDTree(np.array([self.at[n] for n in nodes.tolist()]))

    def find(self, point: FloatArray) -> Held | None:
        """Return the element that holds a place (3,) [m], or the nearest one; None if there are no elements."""
        if not self.members:
            return None
        nodes, tree = self._tree
        _, near = tree.query(point, k=min(NEAREST, len(nodes)))
        tried = dict.fromkeys(e for i in np.atleast_1d(near).tolist() for e in self._of_node[int(nodes[i])])
        found = [held for number in tried if (held := self._in(number, point)) is not None]
        return min(found, key=lambda held: held.distance, default=None)

    def _in(self, number: int, point: FloatArray) -> Held | None:
        family, nodes = self.members[number]
        shape = shape_of(family, len(nodes))
        if shape is None:
            return None
        corners = np.array([self.at[n] for n in nodes])
        at = shape.nodes.mean(axis=0)
        for _ in range(STEPS):
            gap = point - shape.values(at) @ corners
            jacobian = shape.slopes(at) @ corners
            new = shape.inside(at + np.linalg.lstsq(jacobian.T, gap, rcond=None)[0])
            done = bool(np.abs(new - at).max() < 1e-12)
            at = new
            if done:
                break
        weights = shape.values(at)
        slopes = np.linalg.pinv(shape.slopes(at) @ corners) @ shape.slopes(at)
        return Held(
            np.array(nodes), weights, np.asarray(slopes), float(np.linalg.norm(point - weights @ corners))
        )
