"""Added mass in a tank whose surface and bottom may be anywhere: solved at a few distances, read between these.

A distance d counts by its nearness 1 / (1 + d / c side), which is zero for what is not there and in which the added
mass is a smooth function, near a bottom (where it grows as 1 / d) and far from one: a polynomial through few nodes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray

NEAREST = 0.1
"""Least distance in the table, over the shorter side [-]. At half of it one node more is needed."""

TURN = 0.2
"""Distance at which nearness is a half, c above [-]. Among 0.15 to 0.5 the errors given at ``NODES`` are least here,
on a beam of 12 : 1 and on a plate of 2 : 1."""

NODES = 6
"""Distances at which the flow is solved, the infinite one among them: the added mass in between errs by 0.06 % on the
median, 0.3 % at most. Five: 0.4 and 1 %; each more is another dozen solutions."""

SMALL = 1e-7
"""Combinations of the solutions that weigh less than this, relative, are left out [-]."""

Solve = Callable[[float | None, float | None], FloatArray]
"""Added mass (r, r) for distances of surface and bottom, None for one that is not there. [m] to [m^3]"""


@dataclass(frozen=True, eq=False)
class TankTable:
    """Added mass for unit density as a function of the distances of surface and bottom.

    Parameters
    ----------
    side : float
        Shorter side of what is wet [m].
    surfaces, bottoms : (n,) arrays
        Nearness of the nodes; of a distance that is fixed, one [-].
    shares : (n_surfaces, n_bottoms, n_parts) array
        How much of every part is in each solution [-].
    parts : (n_parts, r, r) array
        Of which all solutions are sums [m^3].
    """

    side: float
    surfaces: FloatArray
    bottoms: FloatArray
    shares: FloatArray
    parts: FloatArray

    @classmethod
    def build(cls, solve: Solve, side: float, *, surface: bool = True, bottom: bool = True) -> TankTable:
        """Solve at all nodes.

        Parameters
        ----------
        solve : callable
            Takes the distances of surface and bottom; a fixed one is always asked for as None.
        side : float
            Shorter side of what is wet [m].
        surface, bottom : bool
            Whether their distances are variable.
        """
        surfaces, bottoms = (_nodes() if free else np.zeros(1) for free in (surface, bottom))
        solved = np.array([[solve(*(_distance(x, side) for x in (a, b))) for b in bottoms] for a in surfaces])
        rows = solved.reshape(len(surfaces) * len(bottoms), -1)
        left, size, right = np.linalg.svd(rows, full_matrices=False)
        kept = size > SMALL * size[0]
        shares = (left[:, kept] * size[kept]).reshape(len(surfaces), len(bottoms), -1)
        return cls(side, surfaces, bottoms, shares, right[kept].reshape(-1, *solved.shape[2:]))

    def knows(self, surface: float, bottom: float) -> bool:
        """Return whether two distances are in the table [m]."""
        free = ((surface, self.surfaces), (bottom, self.bottoms))
        return all(far >= NEAREST * self.side for far, nodes in free if len(nodes) > 1)

    def matrix(self, surface: float, bottom: float) -> FloatArray:
        """Return the added mass for two distances, (r, r); infinite ones are not there, fixed ones of no matter [m]."""
        along, across = (
            _weights(nodes, 1.0 / (1.0 + far / (TURN * self.side)))
            for far, nodes in ((surface, self.surfaces), (bottom, self.bottoms))
        )
        return np.asarray(
            np.tensordot(np.einsum("i,ijk,j->k", along, self.shares, across), self.parts, axes=1)
        )


def _nodes() -> FloatArray:
    """Return the nearness of the nodes, Chebyshev's with both ends, (n,) [-]."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.arange(NODES) / (NODES - 1))) / (1.0 + NEAREST / TURN))


def _distance(nearness: float, side: float) -> float | None:
    return TURN * side * (1.0 / nearness - 1.0) if nearness > 0.0 else None


def _weights(nodes: FloatArray, where: float) -> FloatArray:
    """Return the weights of values at nodes in the polynomial through them, (n,) [-]."""
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    away = np.tile(where - nodes, (len(nodes), 1))
    np.fill_diagonal(away, 1.0)
    return np.asarray(away.prod(axis=1) / apart.prod(axis=1))


def unbounded(distance: float | None) -> float:
    """Return a distance, infinite where there is none [m]."""
    return math.inf if distance is None else distance
