"""Structures of straight bars in space: stiffness, mass and node table, part by part.

Two-node bars after Euler and Bernoulli with consistent masses, and springs between coincident nodes; what a few dozen
lines can do that a finite-element program would do otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.io import mmwrite

from acquisition.arrays import FloatArray

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Section:
    """A rectangle: ``width`` along the bar's own second axis, ``height`` along the third [m]; modulus and density."""

    width: float
    height: float
    modulus: float = 210e9
    density: float = 7850.0
    poisson: float = 0.3


@dataclass
class Structure:
    """Nodes, and what is between them, part by part.

    Attributes
    ----------
    places : list
        Coordinates of the nodes, which are counted from 1 [m].
    stiffness, mass : dict of str to list
        Of every part, (rows, matrix) of its elements [SI].
    held : set of int
        Nodes at rest.
    """

    places: list[Place] = field(default_factory=list)
    stiffness: dict[str, list[tuple[list[int], FloatArray]]] = field(default_factory=dict)
    mass: dict[str, list[tuple[list[int], FloatArray]]] = field(default_factory=dict)
    held: set[int] = field(default_factory=set)

    def node(self, at: Place) -> int:
        """Add a node and return its number."""
        self.places.append(at)
        return len(self.places)

    def bar(
        self, part: str, ends: tuple[int, int], section: Section, elements: int, second: Place
    ) -> list[int]:
        """Lay bars of one part between two nodes and return all nodes on the way; ``second`` is their second axis."""
        first, last = (np.array(self.places[end - 1]) for end in ends)
        inner = [self.node(tuple(first + (last - first) * i / elements)) for i in range(1, elements)]
        nodes = [ends[0], *inner, ends[1]]
        along = (last - first) / np.linalg.norm(last - first)
        axes = np.stack([along, second, np.cross(along, second)])
        k, m = element(float(np.linalg.norm(last - first)) / elements, section, axes)
        for a, b in pairwise(nodes):
            self.stiffness.setdefault(part, []).append((rows_of(a) + rows_of(b), k))
            self.mass.setdefault(part, []).append((rows_of(a) + rows_of(b), m))
        return nodes

    def spring(self, part: str, nodes: tuple[int, int], stiffness: Sequence[float]) -> None:
        """Join two nodes by springs along x, y, z [N/m] and about them [N m/rad]."""
        k = np.kron(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.diag(stiffness))
        self.stiffness.setdefault(part, []).append((rows_of(nodes[0]) + rows_of(nodes[1]), k))

    def body(self, part: str, node: int, mass: float, inertia: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        """Put a body on a node [kg, kg m^2]."""
        self.mass.setdefault(part, []).append((rows_of(node), np.diag([mass] * 3 + list(inertia))))

    @property
    def parts(self) -> list[str]:
        """Names of the parts, in the order in which they came."""
        return list(dict.fromkeys([*self.stiffness, *self.mass]))

    @property
    def free(self) -> list[int]:
        """Rows that nothing holds."""
        return [row for n in range(1, len(self.places) + 1) if n not in self.held for row in rows_of(n)]

    def matrix(
        self, kind: str, *, factors: Mapping[str, float] | None = None, parts: Iterable[str] | None = None
    ) -> sparse.csr_array:
        """Return stiffness or mass over the free rows, each part times its factor, of all parts or of some [SI]."""
        size = 6 * len(self.places)
        total = np.zeros((size, size))
        chosen = set(self.parts if parts is None else parts)
        elements = self.stiffness if kind == "stiffness" else self.mass
        for part, own in elements.items():
            for rows, matrix in own if part in chosen else ():
                total[np.ix_(rows, rows)] += (factors or {}).get(part, 1.0) * matrix
        return sparse.csr_array(total[np.ix_(self.free, self.free)])

    def table(self, sets: Mapping[str, Iterable[int]]) -> str:
        """Return the node table, with the node sets to which each node belongs."""
        row_of = {row: i + 1 for i, row in enumerate(self.free)}
        lines = ["node, x, y, z, direction, row, sets"]
        for n, (x, y, z) in enumerate(self.places, start=1):
            own = " ".join(name for name, nodes in sets.items() if n in nodes)
            for direction, row in enumerate(rows_of(n), start=1):
                lines.append(f"{n}, {x:.9g}, {y:.9g}, {z:.9g}, {direction}, {row_of.get(row, '')}, {own}")
        return "\n".join(lines) + "\n"


def rows_of(node: int) -> list[int]:
    """Return the six rows of a node, before any is held."""
    return list(range(6 * (node - 1), 6 * node))


def element(length: float, section: Section, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass (12, 12) of a bar whose own axes are the rows of ``axes`` (3, 3) [SI]."""
    b, h = section.width, section.height
    area, polar = b * h, b * h * (b**2 + h**2) / 12
    shear = section.modulus / (2 * (1 + section.poisson))
    thin, thick = min(b, h), max(b, h)
    torsion = thick * thin**3 * (1 / 3 - 0.21 * thin / thick * (1 - (thin / thick) ** 4 / 12))
    line = section.density * area
    pull, weigh = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    for rows, stiff, heavy in (
        ([0, 6], section.modulus * area / length, line * length),
        ([3, 9], shear * torsion / length, section.density * polar * length),
    ):
        k[np.ix_(rows, rows)] += stiff * pull
        m[np.ix_(rows, rows)] += heavy * weigh
    for rows, sign, bending in (([1, 5, 7, 11], 1.0, h * b**3 / 12), ([2, 4, 8, 10], -1.0, b * h**3 / 12)):
        turned = np.diag([1.0, sign, 1.0, sign])
        k[np.ix_(rows, rows)] += turned @ bent(section.modulus * bending, length) @ turned
        m[np.ix_(rows, rows)] += turned @ carried(line, length) @ turned
    turn = np.kron(np.eye(4), axes)
    return turn.T @ k @ turn, turn.T @ m @ turn


def bent(stiffness: float, length: float) -> FloatArray:
    """Return the bending stiffness (4, 4) of a bar of E I [N m^2]."""
    n = length
    return (
        stiffness
        / n**3
        * np.array(
            [[12, 6 * n, -12, 6 * n], [6 * n, 4 * n**2, -6 * n, 2 * n**2], [-12, -6 * n, 12, -6 * n],
             [6 * n, 2 * n**2, -6 * n, 4 * n**2]]
        )
    )  # fmt: skip


def carried(line: float, length: float) -> FloatArray:
    """Return the consistent mass (4, 4) of a bar of so much mass per length [kg/m]."""
    n = length
    return (
        line
        * n
        / 420
        * np.array(
            [[156, 22 * n, 54, -13 * n], [22 * n, 4 * n**2, 13 * n, -3 * n**2], [54, 13 * n, 156, -22 * n],
             [-13 * n, -3 * n**2, -22 * n, 4 * n**2]]
        )
    )  # fmt: skip


def store(
    structure: Structure,
    folder: Path,
    regions: Mapping[str, Iterable[str]],
    sets: Mapping[str, Iterable[int]],
) -> None:
    """Write ``stiffness.mtx``, ``mass.mtx``, both of every region (``_name``), and ``nodes.csv``."""
    for kind in ("stiffness", "mass"):
        mmwrite(folder / f"{kind}.mtx", structure.matrix(kind), precision=17)
        for name, parts in regions.items():
            mmwrite(folder / f"{kind}_{name}.mtx", structure.matrix(kind, parts=parts), precision=17)
    (folder / "nodes.csv").write_text(structure.table(sets), encoding="ascii")
