"""Finite-element fields sampled at quadrature points and anywhere else.

A field is a sparse matrix: it takes the degrees of freedom to the values of a displacement, a slope or a
curvature at points. Every stiffness and mass matrix of this package is ``A.T @ diag(weights) @ B`` of two
fields, which is why a region, a soft spot or a patch is nothing but other weights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
import skfem
from scipy import sparse
from skfem.element import DiscreteField

from acquisition.arrays import FloatArray, IntArray

Sparse = sparse.csr_array

Matrix = TypeVar("Matrix", Sparse, FloatArray)


@dataclass(frozen=True, eq=False)
class Component:
    """One displacement field: a scikit-fem element on a mesh, and the names of its derivatives.

    Parameters
    ----------
    basis : skfem.CellBasis
        Element on the mesh, with quadrature.
    offset : int
        Where this component's degrees of freedom start in the model's.
    names : mapping of str to tuple of int
        Field names and the directions differentiated along, ``{"w": (), "wxy": (0, 1)}``.
    """

    basis: Any
    offset: int
    names: Mapping[str, tuple[int, ...]]

    def sampled(self, n_dofs: int) -> dict[str, Sparse]:
        """Return the fields at the quadrature points, each (n_points, n_dofs)."""
        if "w" in self.names:
            points = np.asarray(self.basis.global_coordinates())
            return self.hermite(points.reshape(len(points), -1).T, n_dofs, self.names)
        cells = np.repeat(np.arange(self.basis.nelems), self.basis.X.shape[1])
        values = [self.basis.basis[i][0] for i in range(self.basis.Nbfun)]
        return {n: self._matrix(values, d, cells, n_dofs) for n, d in self.names.items()}

    @cached_property
    def _grid(self) -> tuple[tuple[FloatArray, ...], IntArray]:
        """Edges of the elements along each axis, and the degrees of freedom of the node at each crossing.

        Degrees of freedom of a node come in the order w, wx for a beam and w, wx, wy, wxy for a plate.
        """
        mesh = self.basis.mesh
        edges = tuple(np.unique(np.round(axis, 12)) for axis in mesh.p)
        place = tuple(
            np.abs(edge[:, None] - axis[None, :]).argmin(axis=0)
            for edge, axis in zip(edges, mesh.p, strict=True)
        )
        nodal = np.asarray(self.basis.nodal_dofs)
        numbers = np.zeros((*(len(edge) for edge in edges), len(nodal)), dtype=np.int64)
        numbers[place] = nodal.T
        return edges, numbers

    def nodes(self) -> tuple[FloatArray, IntArray]:
        """Return the nodes of a displacement, (n, dim) [m], and their degrees of freedom, (n, 2) or (n, 4)."""
        edges, numbers = self._grid
        at = np.stack(np.meshgrid(*edges, indexing="ij"), axis=-1)
        return at.reshape(-1, len(edges)), numbers.reshape(-1, numbers.shape[-1])

    def at(self, points: FloatArray, n_dofs: int) -> dict[str, Sparse]:
        """Return the displacement and its slopes at any points (n_points, dim) [m], each (n_points, n_dofs).

        The displacement is a product of Hermite cubics, of beams along x and of plates along x and y, so it is
        read from the four (or sixteen) degrees of freedom around a point without the element library's help.
        """
        if "w" not in self.names:
            return self._elsewhere(points, n_dofs)
        return self.hermite(points, n_dofs, self._slopes)

    def on(self, points: FloatArray, basis: FloatArray) -> dict[str, FloatArray]:
        """Return the same on a basis (n_dofs, r), each (n_points, r)."""
        if "w" not in self.names or not len(points):
            return {name: np.asarray(rows @ basis) for name, rows in self.at(points, len(basis)).items()}
        place, values = self._around(points, self._slopes)
        stacked = np.concatenate(list(values.values()))
        rows = _compressed(stacked, np.tile(place, (len(values), 1)), len(basis)) @ basis
        return dict(zip(values, rows.reshape(len(values), len(points), -1), strict=True))

    @property
    def _slopes(self) -> dict[str, tuple[int, ...]]:
        """The displacement and its derivatives along the axes of the model."""
        return {"w": (), "wx": (0,)} | ({"wy": (1,)} if len(self._grid[0]) == 2 else {})

    def hermite(
        self, points: FloatArray, n_dofs: int, names: Mapping[str, tuple[int, ...]]
    ) -> dict[str, Sparse]:
        """Return derivatives of the displacement at any points (n_points, dim) [m], each (n_points, n_dofs).

        ``names`` are the directions differentiated along, as in :attr:`names`; exact on elements however narrow, where
        the element library inverts an ill-conditioned matrix.
        """
        if len(points) == 0:
            return {name: Sparse((0, n_dofs)) for name in names}
        place, values = self._around(points, names)
        return {name: _compressed(one, place, n_dofs) for name, one in values.items()}

    def _around(
        self, points: FloatArray, names: Mapping[str, tuple[int, ...]]
    ) -> tuple[IntArray, dict[str, FloatArray]]:
        """Return the degrees of freedom about each point, (n_points, k), and what each is to derivatives there."""
        edges, numbers = self._grid
        dim, order = len(edges), max(len(along) for along in names.values())
        axes = [_hermite(edge, points[:, i], order) for i, edge in enumerate(edges)]
        cells = tuple(cell for cell, _ in axes)
        ends = np.stack(np.meshgrid(*[(0, 1)] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
        columns = np.stack(
            [numbers[tuple(c + e for c, e in zip(cells, end, strict=True))] for end in ends], 1
        )
        found = {}
        for name, along in names.items():
            parts = [shape[along.count(axis)] for axis, (_, shape) in enumerate(axes)]
            # nodal order: w, wx, wy, wxy, that is (value, slope along x) for each of (value, slope along y)
            values = parts[0] if dim == 1 else np.einsum("pai,pbj->pabji", *parts)
            found[name] = values.reshape(len(points), -1)
        return columns.reshape(len(points), -1) + self.offset, found

    @cached_property
    def _finder(self) -> Any:
        return self.basis.mesh.element_finder(mapping=self.basis.mapping)

    def _elsewhere(self, points: FloatArray, n_dofs: int) -> dict[str, Sparse]:
        """Return all fields at any points by the element library."""
        mesh, mapping = self.basis.mesh, self.basis.mapping
        low, high = mesh.p.min(axis=1), mesh.p.max(axis=1)
        inside = np.clip(points, low, high).T
        cells = self._finder(*inside)
        local = mapping.invF(inside[:, :, None], tind=cells)
        values = [self.basis.elem.gbasis(mapping, local, i, tind=cells)[0] for i in range(self.basis.Nbfun)]
        return {n: self._matrix(values, d, cells, n_dofs) for n, d in self.names.items()}

    def _matrix(self, values: list[Any], derivative: tuple[int, ...], cells: IntArray, n_dofs: int) -> Sparse:
        order = ("value", "grad", "hess")[len(derivative)]
        arrays = [np.asarray(v if order == "value" else getattr(v, order)) for v in values]
        data = np.stack([array[derivative].ravel() for array in arrays])
        rows = np.broadcast_to(np.arange(data.shape[1]), data.shape)
        columns = self.basis.element_dofs[:, cells] + self.offset
        matrix = sparse.coo_array((data.ravel(), (rows.ravel(), columns.ravel())), (data.shape[1], n_dofs))
        return Sparse(matrix)


@dataclass(frozen=True, eq=False)
class Fields:
    """All fields of a model.

    Parameters
    ----------
    components : tuple of Component
        Displacement first; its plain value is the field ``w``.
    dim : int
        1 for a beam, 2 for a plate.
    """

    components: tuple[Component, ...]
    dim: int

    @cached_property
    def n_dofs(self) -> int:
        """Number of degrees of freedom before any is fixed."""
        return sum(int(c.basis.N) for c in self.components)

    @cached_property
    def points(self) -> FloatArray:
        """Quadrature points, shape (n_points, dim) [m]."""
        x = np.asarray(self.components[0].basis.global_coordinates())
        return x.reshape(self.dim, -1).T.copy()

    @cached_property
    def weights(self) -> FloatArray:
        """Quadrature weights, shape (n_points,) [m or m^2]."""
        return np.asarray(self.components[0].basis.dx, dtype=float).ravel()

    @cached_property
    def sampled(self) -> dict[str, Sparse]:
        """Fields at the quadrature points, each (n_points, n_dofs)."""
        return self._sampled()

    def _sampled(self) -> dict[str, Sparse]:
        merged: dict[str, Sparse] = {}
        for component in self.components:
            merged |= component.sampled(self.n_dofs)
        return merged

    @cached_property
    def element_dofs(self) -> IntArray:
        """Degrees of freedom of every element in rising order, (n_elements, k)."""
        own = [np.asarray(c.basis.element_dofs).T + c.offset for c in self.components]
        return np.sort(np.concatenate(own, axis=1), axis=1)

    def by_element(self, name: str) -> FloatArray:
        """Return a field by element: (n_elements, points of one, its degrees of freedom as `element_dofs` has them)."""
        table, matrix = self.element_dofs, self.sampled[name].tocoo()
        points = len(self.weights) // len(table)
        cell = matrix.row // points  # quadrature points are numbered element by element
        # one rising key for each pair of element and degree of freedom: a single search finds all columns
        keys = (np.arange(len(table))[:, None] * self.n_dofs + table).ravel()
        column = (
            np.searchsorted(keys, cell.astype(np.int64) * self.n_dofs + matrix.col) - cell * table.shape[1]
        )
        found = np.zeros((len(table), points, table.shape[1]))
        found[cell, matrix.row % points, column] = matrix.data
        return found

    def at(self, points: FloatArray) -> dict[str, Sparse]:
        """Return the fields of the displacement at any points (n_points, dim) [m]."""
        return self.components[0].at(np.asarray(points, dtype=float).reshape(-1, self.dim), self.n_dofs)

    def on(self, points: FloatArray, basis: FloatArray) -> dict[str, FloatArray]:
        """Return the same on a basis (n_dofs, r), each (n_points, r)."""
        return self.components[0].on(np.asarray(points, dtype=float).reshape(-1, self.dim), basis)


@dataclass(frozen=True, eq=False)
class ShearFields(Fields):
    """Fields of a plate whose sections turn by themselves; without shear those of a thin plate, so that none locks.

    The strain ``gx = dw/dx - theta_x`` is what the slope of the displacement, interpolated at the nodes of the
    rotation, and the rotation there differ by. The section turns by ``rx = dw/dx - gx``, so that where ``gx`` is nil
    it bends exactly as a thin plate does: the hierarchic form of Echter, Oesterle and Bischoff (Comput. Methods Appl.
    Mech. Eng. 254 (2013) 170-180), with rotations at the nodes so that a clamp can hold them. ``gy`` and ``ry``
    likewise.
    """

    def _sampled(self) -> dict[str, Sparse]:
        thin = self.components[0].sampled(self.n_dofs)
        strains: dict[str, Sparse] = {}
        for axis, component in zip("xy", self.components[1:], strict=True):
            slope = self.components[0].at(component.basis.doflocs.T, self.n_dofs)[f"w{axis}"]
            own = sparse.eye_array(slope.shape[0], self.n_dofs, k=component.offset)
            strain = Sparse(slope - own)
            strain.eliminate_zeros()
            for name, interpolated in component.sampled(self.n_dofs).items():
                local = interpolated[:, component.offset : component.offset + slope.shape[0]]
                strains[name.replace("t", "g")] = Sparse(local @ strain)
        return {n: thin[n] for n in ("w", "wx", "wy")} | strains | turned(thin, strains)


def turned(thin: Mapping[str, Matrix], strains: Mapping[str, Matrix]) -> dict[str, Matrix]:
    """Return how sections turn, ``rx`` and ``ry``, and bend, ``rxx``, ``ryy`` and twice the twist ``rt``.

    Parameters
    ----------
    thin : mapping
        Slopes and curvatures of the displacement.
    strains : mapping
        Shear strains ``gx`` and ``gy``, and their derivatives ``gxx``, ``gxy``, ``gyx`` and ``gyy``.
    """
    turns = {f"r{axis}": thin[f"w{axis}"] - strains[f"g{axis}"] for axis in "xy"}
    bends = {f"r{axis * 2}": thin[f"w{axis * 2}"] - strains[f"g{axis * 2}"] for axis in "xy"}
    return turns | bends | {"rt": 2 * thin["wxy"] - strains["gxy"] - strains["gyx"]}


def beam_fields(length: float, elements: int) -> Fields:
    """Hermite cubics: displacement w with continuous slope."""
    mesh = skfem.MeshLine(np.linspace(0.0, length, elements + 1))
    basis = skfem.Basis(mesh, skfem.ElementLineHermite(), intorder=8)
    return Fields((Component(basis, 0, {"w": (), "wx": (0,), "wxx": (0, 0)}),), 1)


def timoshenko_fields(length: float, elements: int) -> Fields:
    """Hermite cubic displacement w with quadratic rotation r of the section: free of shear locking."""
    mesh = skfem.MeshLine(np.linspace(0.0, length, elements + 1))
    deflection = skfem.Basis(mesh, skfem.ElementLineHermite(), intorder=8)
    rotation = skfem.Basis(mesh, skfem.ElementLineP2(), intorder=8)
    return Fields(
        (
            Component(deflection, 0, {"w": (), "wx": (0,)}),
            Component(rotation, int(deflection.N), {"r": (), "rx": (0,)}),
        ),
        1,
    )


PLATE_NAMES = {"w": (), "wx": (0,), "wy": (1,), "wxx": (0, 0), "wyy": (1, 1), "wxy": (0, 1)}


def plate_fields(length: float, width: float, elements: tuple[int, int]) -> Fields:
    """Bogner-Fox-Schmit rectangles: conforming bicubic displacement w of a Kirchhoff plate."""
    mesh = skfem.MeshQuad.init_tensor(
        *(_lines(*side) for side in zip((length, width), elements, strict=True))
    )
    return Fields((Component(skfem.Basis(mesh, _Numbered(), intorder=6), 0, PLATE_NAMES),), 2)


class _Numbered(skfem.ElementQuadBFS):  # type: ignore[misc]
    """Degrees of freedom of bicubic rectangles, whose values are :meth:`Component.hermite`'s.

    The library finds its polynomials as the inverse of a matrix that is singular on elements of 1/500 of the side.
    """

    def gbasis(self, mapping: Any, X: FloatArray, i: int, tind: Any = None) -> tuple[Any, ...]:
        return (DiscreteField(value=np.zeros(mapping.detDF(X, tind).shape)),)


LAYERS = (0.7, 0.25)
"""Width of the elements along the edges of a thick plate, in thicknesses, the first that is narrower than the others
[-]. There the twisting moment dies out over h / sqrt(10), which takes more from modes that twist than all the rest of
shear. With one row of 0.7 h frequencies are 0.01 % off, with 1.5 h 0.05 %, with none 0.15 % on elements of 3 h; on
elements of 0.7 h none leaves 0.03 % and 0.4 % of the shapes of modes 2 % apart, 0.25 h leaves 0.002 % and 0.1 %."""

NARROWER = 0.7
"""So narrow is an element along an edge, relative to the others at most [-]: less of a difference does nothing."""


def mindlin_fields(length: float, width: float, elements: tuple[int, int], thickness: float) -> ShearFields:
    """Bicubic displacement w, biquadratic rotations of the section about both axes, narrow elements at the edges."""
    sides = zip((length, width), elements, strict=True)
    mesh = skfem.MeshQuad.init_tensor(
        *(_lines(*side, [layer * thickness for layer in LAYERS]) for side in sides)
    )
    deflection = skfem.Basis(mesh, _Numbered(), intorder=6)
    rotation = skfem.Basis(mesh, skfem.ElementQuad2(), intorder=6)
    first, count = int(deflection.N), int(rotation.N)
    turns = [
        Component(rotation, first + i * count, {f"t{a}": (), f"t{a}x": (0,), f"t{a}y": (1,)})
        for i, a in enumerate("xy")
    ]
    return ShearFields((Component(deflection, 0, PLATE_NAMES), *turns), 2)


def _lines(size: float, elements: int, layers: Sequence[float] = ()) -> FloatArray:
    """Return where elements end along a side, at both ends narrow ones of the first width that fits in [m]."""
    even = np.linspace(0.0, size, elements + 1)
    fitting = [one for one in layers if one < NARROWER * size / elements][:1]
    return np.unique(np.concatenate([even, *([layer, size - layer] for layer in fitting)]))


ON_A_NODE = 1e-9
"""So near to the end of an element, relative to its length, a place is on it, and independent of the next one [-]."""


def _compressed(values: FloatArray, place: IntArray, n_dofs: int) -> Sparse:
    """Return a matrix (n, n_dofs) that has values (n, k) in some columns of each row."""
    start = np.arange(len(values) + 1) * values.shape[1]
    return Sparse((values.ravel(), place.ravel(), start), shape=(len(values), n_dofs))


def _hermite(edges: FloatArray, x: FloatArray, order: int) -> tuple[IntArray, list[FloatArray]]:
    """Return the element each place lies in, and Hermite's cubics and their derivatives there.

    Parameters
    ----------
    edges : (n_elements + 1,) array
        Where elements end [m].
    x : (n,) array
        Places [m].
    order : int
        Of the highest derivative that is asked for, at most 2.

    Returns
    -------
    cell : (n,) int array
    shapes : list of order + 1 (n, 2, 2) arrays
        Value and derivatives of the cubics of each end's displacement [-] and slope [m]; places outside count as the
        end.
    """
    x = np.clip(x, edges[0], edges[-1])
    cell = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    h = edges[cell + 1] - edges[cell]
    t = (x - edges[cell]) / h
    t = np.where(np.abs(t - np.round(t)) < ON_A_NODE, np.round(t), t)
    shapes = [[(1 + 2 * t) * (1 - t) ** 2, h * t * (1 - t) ** 2, t**2 * (3 - 2 * t), h * t**2 * (t - 1)]]
    if order > 0:
        shapes.append([6 * t * (t - 1) / h, (1 - t) * (1 - 3 * t), 6 * t * (1 - t) / h, t * (3 * t - 2)])
    if order > 1:
        shapes.append([(12 * t - 6) / h**2, (6 * t - 4) / h, (6 - 12 * t) / h**2, (6 * t - 2) / h])
    return cell, [np.stack(one, axis=1).reshape(-1, 2, 2) for one in shapes]
