"""Matrices of blocks, each part by a run of CalculiX, put together part by part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray, IntArray
from modalkit.simulator.bodies.block.shape import Mesh, Shape
from modalkit.simulator.bodies.solid.deck import Bricks, finished, mesh_lines

Matrix = sparse.csr_array


@dataclass(frozen=True, eq=False)
class Assembled:
    """A shape in bricks with its matrices for E = 1 Pa and a density of 1 kg/m3, x, y and z of every node in turn.

    Parameters
    ----------
    mesh : Mesh
        Bricks and nodes.
    parts : mapping of str to (stiffness, mass)
        Of every part, each (order, order).
    """

    mesh: Mesh
    parts: Mapping[str, tuple[Matrix, Matrix]]

    @property
    def order(self) -> int:
        """Number of rows."""
        return 3 * len(self.mesh.nodes[0])

    @cached_property
    def volume(self) -> float:
        """Of all parts [m3]."""
        along = np.tile([0.0, 0.0, 1.0], self.order // 3)
        return float(sum(along @ (mass @ along) for _, mass in self.parts.values()))

    @cached_property
    def feet(self) -> Mapping[str, IntArray]:
        """Nodes of every foot, by their indices."""
        return {name: self.mesh.on(box) for name, box in self.mesh.shape.feet}

    @cached_property
    def bolts(self) -> Mapping[str, tuple[IntArray, IntArray]]:
        """Nodes of both sides of every bolt, each at the place of the other's."""
        return {
            name: (self.mesh.on(box, 0, corners=True), self.mesh.on(box, 1, corners=True))
            for name, box in self.mesh.shape.bolts
        }

    def springs(self, bolt: str) -> Matrix:
        """Return the stiffness of a bolt of 1 N/m in every direction, (order, order) [N/m]."""
        first, second = self.bolts[bolt]
        share = 1.0 / len(first)
        a = (3 * first[:, None] + np.arange(3)).ravel()
        b = (3 * second[:, None] + np.arange(3)).ravel()
        values = np.repeat([share, share, -share, -share], len(a))
        rows, columns = np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a])
        return Matrix(sparse.coo_array((values, (rows, columns)), shape=(self.order,) * 2))

    @cached_property
    def top(self) -> IntArray:
        """Indices of the nodes where lines cross on the plate's upper face, (n_x + 1, n_y + 1)."""
        numbers, _ = self.mesh.nodes
        i, j = np.meshgrid(2 * np.arange(len(self.mesh.x)), 2 * np.arange(len(self.mesh.y)), indexing="ij")
        some = next(iter(self.mesh.bricks.values()))
        return np.searchsorted(numbers, some.number(i, j, np.full_like(i, 2 * len(self.mesh.z) - 2)))


@lru_cache(maxsize=16)
def assembled(shape: Shape, elements: int, element: str, poisson: float) -> Assembled:
    """Return the matrices of a shape.

    Parameters
    ----------
    shape : Shape
        What it is made of.
    elements : int
        Bricks along its length [-].
    element : {"C3D20R", "C3D20"}
        Their kind.
    poisson : float
        Poisson's ratio [-].

    Raises
    ------
    StudyError
        If CalculiX is missing or fails.
    """
    mesh = shape.mesh(elements)
    numbers, _ = mesh.nodes
    found = {}
    for name, _, body in shape.parts:
        stiffness, mass, node, direction = _run(mesh.bricks[name], element, poisson)
        rows = 3 * np.searchsorted(numbers, node + body * mesh.count) + direction - 1
        found[name] = tuple(_spread(m, rows, 3 * len(numbers)) for m in (stiffness, mass))
    return Assembled(mesh, {name: (k, m) for name, (k, m) in found.items()})


def added(matrices: Sequence[Matrix]) -> Matrix:
    """Return the sum of one matrix or more."""
    total = matrices[0]
    for matrix in matrices[1:]:
        total = Matrix(total + matrix)
    return total


def _spread(matrix: sparse.coo_array, rows: IntArray, order: int) -> Matrix:
    return Matrix(sparse.coo_array((matrix.data, (rows[matrix.row], rows[matrix.col])), shape=(order, order)))


def _run(
    bricks: Bricks, element: str, poisson: float
) -> tuple[sparse.coo_array, sparse.coo_array, IntArray, IntArray]:
    """Return stiffness and mass of bricks that nothing holds, and node and direction of every row."""
    with finished(_deck(bricks, element, poisson), ("sti", "mas", "dof")) as files:
        names = np.array([line.split(".") for line in files[2].read_text().split()], dtype=np.int64)
        stiffness, mass = (_symmetric(np.loadtxt(file), len(names)) for file in files[:2])
    return stiffness, mass, names[:, 0], names[:, 1]


def _symmetric(entries: FloatArray, order: int) -> sparse.coo_array:
    """Return a matrix of whose two triangles one is stored."""
    row, column = (entries[:, :2] - 1).astype(np.int64).T
    off = row != column
    values = np.concatenate([entries[:, 2], entries[off, 2]])
    rows, columns = np.concatenate([row, column[off]]), np.concatenate([column, row[off]])
    return sparse.coo_array((values, (rows, columns)), shape=(order, order))


def _deck(bricks: Bricks, element: str, poisson: float) -> str:
    lines = mesh_lines(bricks, element)
    lines += ["*MATERIAL, NAME=BULK", "*ELASTIC", f"1., {poisson:.12e}", "*DENSITY", "1."]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=BULK"]
    lines += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"]
    return "\n".join(lines) + "\n"
