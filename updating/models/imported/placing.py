"""Motion at any place and in any direction from the rows of the nodes around it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np
from scipy import sparse
from scipy.spatial import KDTree

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.imported.elements import Elements
from updating.models.imported.nodes import HELD, NodeTable

NEIGHBOURS = {0: 1, 1: 7, 2: 21, 3: 45}
"""Nodes from which a motion is interpolated, by the number of dimensions they spread in."""

FLAT = 0.02
"""Nodes that spread less than this in a direction, relative to their reach, lie in a plane or on a line [-]."""

AT = 1e-3
"""So near to a node, relative to the spacing, a point is at it [-]."""

BEYOND = 0.3
"""How far beyond the last nodes a point may lie, relative to the spacing [-]."""


SIDE = "side"
"""How the names of rows begin in which several nodes at one place move differently from their mean."""


@dataclass(frozen=True, eq=False)
class Found:
    """A point among the nodes.

    Parameters
    ----------
    index : (k,) int array
        Nodes used.
    weights : (k,) array
        Their shares in the motion at the point [-].
    slopes : (3, k) array
        Their shares in its derivatives along x, y and z [1/m].
    sides : (s, k) array
        Their shares in what one of several nodes at the point moves differently from the mean of these, in independent
        parts of unit variance; which of the nodes is meant is not known. Empty where there is one [-].
    nearest : int
        The nearest node.
    distance, spacing, beyond : float
        How far it is, how far its own neighbours are from it, and how far the point lies outside them all [m].
    """

    index: IntArray
    weights: FloatArray
    slopes: FloatArray
    sides: FloatArray
    nearest: int
    distance: float
    spacing: float
    beyond: float

    @property
    def on(self) -> bool:
        """Whether the point lies on the structure, as far as the nodes show."""
        return self.distance <= self.spacing and self.beyond <= BEYOND * self.spacing


@dataclass(frozen=True, eq=False)
class Places:
    """The nodes of imported matrices.

    Parameters
    ----------
    node : (n,) int array
        Node numbers.
    at : (n, 3) array
        Coordinates [m].
    moves : tuple of 3 sparse arrays, each (n, n_dofs)
        Displacement of the nodes along x, y and z.
    turns : tuple of 3 sparse arrays, each (n, n_dofs)
        Rotation about x, y and z.
    known : (6, n) bool array
        Which of these the matrices hold, or a support.
    elements : Elements, optional
        The elements between the nodes, where they are known.
    """

    node: IntArray
    at: FloatArray
    moves: tuple[Sparse, ...]
    turns: tuple[Sparse, ...]
    known: BoolArray
    elements: Elements | None = None

    @classmethod
    def of(cls, table: NodeTable, order: int) -> Places:
        """Gather the rows of a node table by node."""
        node, first, where = np.unique(table.node, return_index=True, return_inverse=True)
        known = np.zeros((6, len(node)), dtype=bool)
        known[table.direction - 1, where] = True
        motions = []
        for direction in range(1, 7):
            chosen = (table.direction == direction) & (table.row != HELD)
            of = where[chosen]
            share = 1.0 / np.bincount(of, minlength=len(node))[of] if chosen.any() else np.zeros(0)
            entries = (share, (of, table.row[chosen]))
            motions.append(Sparse(sparse.coo_array(entries, (len(node), order)).tocsr()))
        return cls(node, table.places[first], tuple(motions[:3]), tuple(motions[3:]), known)

    @property
    def solid(self) -> bool:
        """Whether the nodes are those of bricks: they lie in three dimensions, move along all axes and do not turn."""
        spread = len(_spread(self.at)[1]) if len(self.at) > NEIGHBOURS[1] else 0
        return spread == 3 and bool(self.known[:3].any(axis=1).all()) and not self.known[3:].any()

    @cached_property
    def _trees(self) -> tuple[tuple[IntArray, KDTree] | None, ...]:
        chosen = [np.flatnonzero(known) for known in self.known]
        return tuple((index, KDTree(self.at[index])) if len(index) else None for index in chosen)

    def has(self, axis: int) -> bool:
        """Return whether any node is known to move along an axis 0, 1, 2, or to turn about it, 3, 4, 5."""
        return self._trees[axis] is not None

    def find(self, point: FloatArray, axis: int) -> Found:
        """Return the shares of nodes in the motion at a point: those of the element that holds it, else of a fit.

        The fit is a cubic surface through the nodes about the point, nearest nodes weighing most: moving least squares
        (Lancaster and Salkauskas 1981) with weights that fall with the fourth power of the distance, so that at a node
        only the node counts. Where several nodes are at the point, as the two sides of a joint are, their mean counts.

        Parameters
        ----------
        point : (3,) array
            Place in model axes [m].
        axis : int
            0, 1, 2 for displacement along x, y, z; 3, 4, 5 for rotations: nodes that have it are asked.
        """
        entry = self._trees[axis]
        assert entry is not None
        index, tree = entry
        if (held := self._held(point, axis)) is not None:
            return held
        count = min(NEIGHBOURS[3], len(index))
        distance, near = (np.atleast_1d(a) for a in tree.query(point, k=count))
        near = near.astype(np.int64)
        spread, axes = _spread(self.at[index[near]])
        count = min(NEIGHBOURS[len(axes)], count)
        distance, near = distance[:count], near[:count]
        around = min(9 if len(axes) > 1 else 3, len(index))
        spacing = float(np.atleast_1d(tree.query(self.at[index[near[0]]], k=around)[0])[-1]) or spread
        weights, slopes = _fit((self.at[index[near]] - point) / spacing, distance / spacing, axes)
        sides = np.zeros((0, count))
        if distance[0] <= AT * spacing:
            weights, sides = _of_sides(self._meant(index[near], distance <= AT * spacing, axis))
        return Found(
            index=index[near],
            weights=weights,
            slopes=slopes / spacing,
            sides=sides,
            nearest=int(index[near[0]]),
            distance=float(distance[0]),
            spacing=spacing,
            beyond=_beyond((self.at[index[near[:around]]] - point) @ axes.T),
        )

    def _meant(self, index: IntArray, there: BoolArray, axis: int) -> BoolArray:
        """Return which of some nodes a point at a node may be, (k,): those ``there`` that move, or all if none does."""
        moving = self._moving[axis][index] & there
        return moving if moving.any() else there

    @cached_property
    def _moving(self) -> BoolArray:
        """Which nodes the matrices move along and about each axis, (6, n): the others are held by a support."""
        return np.array([np.diff(motion.indptr) > 0 for motion in (*self.moves, *self.turns)])

    def _held(self, point: FloatArray, axis: int) -> Found | None:
        """Return the shares of the element that holds a point; None where there is none, or a node of it has no row."""
        element = None if self.elements is None else self.elements.find(point)
        if element is None or axis > 2:
            return None
        index = np.searchsorted(self.node, element.nodes)
        there = self.node[np.minimum(index, len(self.node) - 1)] == element.nodes
        if not there.all() or not self.known[axis][index].all():
            return None
        away = np.linalg.norm(self.at[index] - point, axis=1)
        spacing = float(np.median(np.linalg.norm(self.at[index] - self.at[index].mean(axis=0), axis=1)))
        nearest = int(index[np.argmin(away)])
        return Found(
            index=index,
            weights=element.weights,
            slopes=element.slopes,
            sides=np.zeros((0, len(index))),
            nearest=nearest,
            distance=element.distance,
            spacing=spacing,
            beyond=element.distance,
        )

    def rows(self, points: FloatArray, directions: FloatArray) -> dict[str, Sparse]:
        """Return displacement and slopes along directions at points, each (n_points, n_dofs).

        Parameters
        ----------
        points, directions : (n_points, 3) arrays
            Places [m] and unit vectors; an axis that no node moves along is at rest.

        Returns
        -------
        dict
            ``w`` the displacement along the direction; ``wx``, ``wy``, ``wz`` its derivatives along x, y and z as far
            as they lie in the surface that is hit, across the direction. ``side0`` and more, where several nodes are at
            one of the points: what the one that is meant moves differently from ``w``, see :class:`Found`.
        """
        n = self.moves[0].shape[1]
        names = ("w", "wx", "wy", "wz")
        total = {name: [Sparse((1, n))] * len(points) for name in names}
        for i, (point, along) in enumerate(zip(points, directions, strict=True)):
            across = np.eye(3) - np.outer(along, along)
            for axis in range(3):
                if abs(along[axis]) < 1e-9 or not self.has(axis):
                    continue
                found = self.find(point, axis)
                sides = [f"{SIDE}{k}" for k in range(len(found.sides))]
                moved = Sparse(np.vstack([found.weights, found.sides])) @ self.moves[axis][found.index]
                each = Sparse(sparse.vstack([moved, Sparse(across) @ self._gradient(found, axis)]))
                for k, name in enumerate(("w", *sides, *names[1:])):
                    total.setdefault(name, [Sparse((1, n))] * len(points))
                    total[name][i] = Sparse(total[name][i] + along[axis] * each[[k]])
        return {name: Sparse(sparse.vstack(rows)) if rows else Sparse((0, n)) for name, rows in total.items()}

    def _gradient(self, found: Found, axis: int) -> Sparse:
        """Return the derivatives of a displacement at a point along x, y and z, (3, n_dofs) [1/m].

        At a node that turns, the section about it turns with it: u + theta x r. Nodes around a point do not tell how a
        bar twists, nor what either of two does that meet there.
        """
        fitted = Sparse(Sparse(found.slopes) @ self.moves[axis][found.index])
        if found.distance > AT * found.spacing:
            return fitted
        used, weights = found.index[found.weights != 0], Sparse(found.weights[None, :])
        after, last = (axis + 1) % 3, (axis + 2) % 3
        known: dict[int, Sparse] = {}
        for along, about, sign in ((after, last, -1.0), (last, after, 1.0)):
            if self._moving[3 + about, used].all():
                known[along] = Sparse(sign * weights @ self.turns[about][found.index])
        if len(known) == 2:  # what is left along the axis itself is a strain
            known[axis] = Sparse(fitted[[axis]].shape)
        return Sparse(sparse.vstack([known.get(along, fitted[[along]]) for along in range(3)]))

    def motions(self, points: FloatArray, axes: range = range(3)) -> Sparse:
        """Return all displacements (or rotations, axes 3 to 5) that the matrices have at points (n, 3) [m]."""
        rows = [Sparse((0, self.moves[0].shape[1]))]
        every = (*self.moves, *self.turns)
        for point in points:
            for axis in axes:
                if self.has(axis):
                    found = self.find(point, axis)
                    rows.append(Sparse(found.weights[None, :]) @ every[axis][found.index])
        return Sparse(sparse.vstack(rows))


def _spread(places: FloatArray) -> tuple[float, FloatArray]:
    """Return how far places reach [m], and the axes (dim, 3) in which they spread."""
    centred = places - places.mean(axis=0)
    _, size, axes = np.linalg.svd(centred, full_matrices=False)
    reach = float(np.sqrt((centred**2).sum(axis=1)).max())
    return max(reach, 1e-12), axes[size > FLAT * max(size[0], 1e-300)] if reach > 0 else axes[:0]


def _beyond(offset: FloatArray) -> float:
    """Return how far the origin lies outside places (k, dim), measured towards their middle [m]."""
    middle = offset.mean(axis=0)
    length = float(np.linalg.norm(middle))
    return max(float((offset @ middle).min()) / length, 0.0) if length > 0 else 0.0


def _of_sides(meant: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return the shares (n,) of nodes in the mean of those meant, and in what one of them moves differently, (s, n).

    One of m nodes, each as likely, has the mean and a covariance of (1 - 1/m) / m along m - 1 directions.
    """
    several = np.flatnonzero(meant)
    mean = meant / len(several)
    apart = np.linalg.svd(np.eye(len(several)) - 1.0 / len(several))[0][:, : len(several) - 1]
    sides = np.zeros((len(several) - 1, len(meant)))
    sides[:, several] = apart.T / np.sqrt(len(several))
    return mean, sides


def _fit(offset: FloatArray, distance: FloatArray, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the shares (k,) in the value and (3, k) in the gradient, at the origin, of a cubic fitted to places."""
    local = offset @ axes.T
    dim = local.shape[1]
    higher = [
        np.prod(local[:, powers], axis=1)
        for degree in (2, 3)
        for powers in combinations_with_replacement(range(dim), degree)
    ]
    terms = np.column_stack([np.ones(len(local)), local, *higher])
    weight = 1 / (distance**2 + AT**2)
    solution = np.linalg.pinv(terms * weight[:, None], rcond=1e-9) * weight
    return np.asarray(solution[0]), np.asarray(axes.T @ solution[1 : 1 + dim])
