"""Frames of straight bars with masses at their nodes: matrices, node tables and frequencies by another way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigvalsh

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable


@dataclass(frozen=True, eq=False)
class Frame:
    """Matrices of a frame.

    Parameters
    ----------
    stiffness, mass : (n, n) arrays
        Of the rows that are left [SI].
    places : (n_nodes, 3) array
        Its nodes [m].
    rows : (n,) int array
        Which of the six motions of each node the rows are: 6 node + direction.
    """

    stiffness: FloatArray
    mass: FloatArray
    places: FloatArray
    rows: IntArray

    def imported(self) -> Imported:
        """Return it as matrices read from a file."""
        node, direction = np.divmod(self.rows, 6)
        table = NodeTable(node + 1, self.places[node], direction + 1, np.arange(len(self.rows)))
        return Imported(Sparse(self.stiffness), Sparse(self.mass), table, source="frame")

    def on(self, scale: FloatArray, order: IntArray) -> Frame:
        """Return it with its rows in another order and unit (n,)."""
        by = np.outer(scale, scale)
        cut = np.ix_(order, order)
        return Frame(
            (by * self.stiffness)[cut], (by * self.mass)[cut], self.places, np.asarray(self.rows[order])
        )

    def rounded(self, digits: int) -> Frame:
        """Return it with the stiffness in so many significant digits."""
        words = [[float(f"{value:.{digits - 1}e}") for value in row] for row in self.stiffness]
        return Frame(np.array(words), self.mass, self.places, self.rows)

    def frequencies(self, count: int) -> FloatArray:
        """Return the lowest frequencies with rows of no more than the lightest mass condensed (Guyan) [Hz]."""
        heavy = self.mass.diagonal() > 1e-6 * self.mass.diagonal().max()
        light = ~heavy
        k = self.stiffness
        rest = k[np.ix_(heavy, light)] @ np.linalg.pinv(k[np.ix_(light, light)], rcond=1e-13, hermitian=True)
        condensed = k[np.ix_(heavy, heavy)] - rest @ k[np.ix_(light, heavy)]
        values = eigvalsh((condensed + condensed.T) / 2, self.mass[np.ix_(heavy, heavy)])
        return np.sqrt(np.maximum(values[:count], 0.0)) / (2 * np.pi)


def frame(
    places: Sequence[Sequence[float]],
    bars: Sequence[tuple[int, int]],
    *,
    held: Sequence[int] = (),
    pinned: Sequence[int] = (),
    stiffer: dict[int, float] | None = None,
    inertia: float = 0.0,
    seed: int | None = None,
    motions: Sequence[int] = range(6),
) -> Frame:
    """Return a frame of steel tubes (EA 4e7 N, EI 3e4 N m2, GJ 2e4 N m2) with 2 kg at its nodes.

    Parameters
    ----------
    places : sequence of points
        Nodes [m].
    bars : sequence of pairs
        Nodes that bars join.
    held, pinned : sequence of int
        Nodes that cannot move, and that can only turn.
    stiffer : dict of int to float, optional
        How many times as stiff some bars are.
    inertia : float
        Rotary inertia at the nodes [kg m2].
    seed : int, optional
        Of the scatter of sections and masses; left out, all are alike.
    motions : sequence of int
        Directions that nodes have.
    """
    at = np.array(places, dtype=float)
    rng = None if seed is None else np.random.default_rng(seed)
    stiffness = np.zeros((6 * len(at),) * 2)
    for number, (a, b) in enumerate(bars):
        own = (stiffer or {}).get(number, 1.0) * (1.0 if rng is None else rng.uniform(0.5, 2.0))
        dofs = np.r_[6 * a : 6 * a + 6, 6 * b : 6 * b + 6]
        stiffness[np.ix_(dofs, dofs)] += own * bar(at[b] - at[a])
    weights = np.full(len(at), 2.0) if rng is None else rng.uniform(1.0, 3.0, len(at))
    mass = np.concatenate([np.r_[w * np.ones(3), inertia * np.ones(3)] for w in weights])
    node, direction = np.divmod(np.arange(6 * len(at)), 6)
    free = ~np.isin(node, held) & ~(np.isin(node, pinned) & (direction < 3)) & np.isin(direction, motions)
    rows = np.flatnonzero(free)
    return Frame(stiffness[np.ix_(rows, rows)], np.diag(mass[rows]), at, rows)


def bar(along: FloatArray) -> FloatArray:
    """Return the stiffness (12, 12) of a bar between two nodes, its section round [SI]."""
    length = float(np.linalg.norm(along))
    first = along / length
    second = np.cross(first, [1.0, 0, 0] if abs(first[0]) < 0.9 else [0, 1.0, 0])
    second /= np.linalg.norm(second)
    turned = np.kron(np.eye(4), np.stack([first, second, np.cross(first, second)]))
    local = np.zeros((12, 12))
    pull = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    local[np.ix_([0, 6], [0, 6])] = 4e7 * pull
    local[np.ix_([3, 9], [3, 9])] = 2e4 * pull
    a, b = 6 * length, length * length
    bend = np.array([[12, a, -12, a], [a, 4 * b, -a, 2 * b], [-12, -a, 12, -a], [a, 2 * b, -a, 4 * b]]) * (
        3e4 / length**3
    )
    signs = np.array([1, -1, 1, -1])
    local[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])] = bend
    local[np.ix_([2, 4, 8, 10], [2, 4, 8, 10])] = bend * np.outer(signs, signs)
    found = turned.T @ local @ turned
    return np.asarray((found + found.T) / 2)


def line(count: int, step: Sequence[float]) -> list[list[float]]:
    """Return places in a row."""
    return [[i * s for s in step] for i in range(count)]


def chain(count: int) -> list[tuple[int, int]]:
    """Return bars that join nodes in their order."""
    return [(i, i + 1) for i in range(count - 1)]
