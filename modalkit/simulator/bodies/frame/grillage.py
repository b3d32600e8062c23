"""Bars in a plane that bend and twist across it: matrices, part by part, and where they are.

Every node has a deflection w and its slopes p = dw/dx and q = dw/dy. A bar along (c, s) bends with the slope c p + s q
(Hermite cubics) and twists by c q - s p (linear); see Przemieniecki (1968), Theory of Matrix Structural Analysis, 5.6.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Bar:
    """One bar between two nodes.

    Parameters
    ----------
    part : str
        What it belongs to.
    nodes : (int, int)
        Its ends.
    """

    part: str
    nodes: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Grillage:
    """Nodes with bars and springs between them.

    Parameters
    ----------
    places : (n, 2) array
        Of the nodes [m].
    bars : tuple of Bar
        The bars.
    joints : mapping of str to (int, int)
        Nodes at one place that springs join.
    """

    places: FloatArray
    bars: tuple[Bar, ...]
    joints: Mapping[str, tuple[int, int]]

    @property
    def order(self) -> int:
        """Number of rows: w, p and q of every node."""
        return 3 * len(self.places)

    def parts(
        self, section: tuple[float, float], material: tuple[float, float, float]
    ) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Return stiffness and mass of every part, (order, order) [SI].

        Parameters
        ----------
        section : (breadth, depth)
            Of the bars, depth across the plane [m].
        material : (E, density, poisson)
            [Pa], [kg/m3], [-].
        """
        found: dict[str, tuple[FloatArray, FloatArray]] = {}
        for bar in self.bars:
            first, last = self.places[list(bar.nodes)]
            rows = rows_of(bar.nodes)
            stiffness, mass = found.setdefault(
                bar.part, (np.zeros((self.order,) * 2), np.zeros((self.order,) * 2))
            )
            k, m = element(last - first, section, material)
            stiffness[np.ix_(rows, rows)] += k
            mass[np.ix_(rows, rows)] += m
        return found

    def springs(self, joint: str, shift: float, turn: float) -> FloatArray:
        """Return the stiffness (order, order) of a joint of so much against shifting [N/m] and turning [N m/rad]."""
        total = np.zeros((self.order,) * 2)
        rows = rows_of(self.joints[joint])
        across = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag([shift, turn, turn]))
        total[np.ix_(rows, rows)] = across
        return total

    def reads(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows (n, order) that read ``w``, ``slope_x`` or ``slope_y`` at places (n, 2), of the nearest bar."""
        found = np.zeros((len(places), self.order))
        ends = self.places[np.array([bar.nodes for bar in self.bars])]
        for i, place in enumerate(places):
            share, away = _beside(ends, place)
            nearest = int(np.argmin(away))
            found[i, rows_of(self.bars[nearest].nodes)] = _reader(
                ends[nearest], place, share[nearest], quantity
            )
        return found


def rows_of(nodes: Iterable[int]) -> IntArray:
    """Return the rows of some nodes."""
    return np.concatenate([np.arange(3 * node, 3 * node + 3) for node in nodes])


def _beside(ends: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far along each bar (n, 2, 2) a place lies [-], and how far from it [m]."""
    along = ends[:, 1] - ends[:, 0]
    share = np.clip(np.sum((place - ends[:, 0]) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    return share, np.linalg.norm(ends[:, 0] + share[:, None] * along - place, axis=1)


def _reader(ends: FloatArray, place: FloatArray, share: float, quantity: str) -> FloatArray:
    """Return the weights (6,) of a bar's rows in a quantity at a place on it, or a little beside."""
    along = ends[1] - ends[0]
    length = float(np.linalg.norm(along))
    c, s = along / length
    x = float(share)
    scale = np.array([1.0, length, 1.0, length])
    shape = scale * [1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2]
    slope = scale * [-6 * x + 6 * x**2, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x]
    deflection, bent, twist = np.zeros(6), np.zeros(6), np.zeros(6)
    deflection[[0, 1, 3, 4]], bent[[0, 1, 3, 4]], twist[[2, 5]] = shape, slope / length, (1 - x, x)
    turned = _turned(c, s)
    if quantity == "w":
        across = float(np.array([-s, c]) @ (place - ends[0]))
        return np.asarray((deflection + across * twist) @ turned)
    mixed = c * bent - s * twist if quantity == "slope_x" else s * bent + c * twist
    return np.asarray(mixed @ turned)


def _turned(c: float, s: float) -> FloatArray:
    """Return the bar's own w, slope along and twist, at both ends, from w, p and q (6, 6)."""
    return np.kron(np.eye(2), np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]))


def element(
    along: FloatArray, section: Sequence[float], material: Sequence[float]
) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass (6, 6) of a bar, over w, p and q of both ends [SI]."""
    length = float(np.linalg.norm(along))
    (breadth, depth), (modulus, density, poisson) = section, material
    thin, thick = sorted((breadth, depth))
    torsion = thick * thin**3 * (1 / 3 - 0.21 * thin / thick * (1 - (thin / thick) ** 4 / 12))
    polar = density * breadth * depth * (breadth**2 + depth**2) / 12
    bend, line = modulus * breadth * depth**3 / 12 / length**3, density * breadth * depth * length / 420
    n = length
    hermite_k = [[12, 6 * n, -12, 6 * n], [6 * n, 4 * n**2, -6 * n, 2 * n**2],
                 [-12, -6 * n, 12, -6 * n], [6 * n, 2 * n**2, -6 * n, 4 * n**2]]  # fmt: skip
    hermite_m = [[156, 22 * n, 54, -13 * n], [22 * n, 4 * n**2, 13 * n, -3 * n**2],
                 [54, 13 * n, 156, -22 * n], [-13 * n, -3 * n**2, -22 * n, 4 * n**2]]  # fmt: skip
    k, m = np.zeros((6, 6)), np.zeros((6, 6))
    bending, twisting = np.ix_([0, 1, 3, 4], [0, 1, 3, 4]), np.ix_([2, 5], [2, 5])
    k[bending], m[bending] = bend * np.array(hermite_k), line * np.array(hermite_m)
    stiff = modulus / (2 * (1 + poisson)) * torsion / length
    k[twisting] = stiff * np.array([[1.0, -1.0], [-1.0, 1.0]])
    m[twisting] = (
        polar * length * np.array([[5.0, 1.0], [1.0, 5.0]]) / 12
    )  # half consistent, half lumped: order 4
    turn = _turned(*(along / length))
    return turn.T @ k @ turn, turn.T @ m @ turn
