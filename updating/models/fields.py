"""Finite-element fields sampled at quadrature points and anywhere else.

A field is a sparse matrix: it takes the degrees of freedom to the values of a displacement, a slope or a
curvature at points. Every stiffness and mass matrix of this package is ``A.T @ diag(weights) @ B`` of two
fields, which is why a region, a soft spot or a patch is nothing but other weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import skfem
from scipy import sparse

from acquisition.arrays import FloatArray, IntArray

Sparse = sparse.csr_array


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
        cells = np.repeat(np.arange(self.basis.nelems), self.basis.X.shape[1])
        values = [self.basis.basis[i][0] for i in range(self.basis.Nbfun)]
        return {n: self._matrix(values, d, cells, n_dofs) for n, d in self.names.items()}

    @cached_property
    def _finder(self) -> Any:
        return self.basis.mesh.element_finder(mapping=self.basis.mapping)

    def at(self, points: FloatArray, n_dofs: int) -> dict[str, Sparse]:
        """Return the fields at any points (n_points, dim) [m], each (n_points, n_dofs)."""
        if len(points) == 0:
            return {name: Sparse((0, n_dofs)) for name in self.names}
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
        merged: dict[str, Sparse] = {}
        for component in self.components:
            merged |= component.sampled(self.n_dofs)
        return merged

    def at(self, points: FloatArray) -> dict[str, Sparse]:
        """Return the fields of the displacement at any points (n_points, dim) [m]."""
        return self.components[0].at(np.asarray(points, dtype=float).reshape(-1, self.dim), self.n_dofs)


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


def plate_fields(length: float, width: float, elements: tuple[int, int]) -> Fields:
    """Bogner-Fox-Schmit rectangles: conforming bicubic displacement w of a Kirchhoff plate."""
    mesh = skfem.MeshQuad.init_tensor(
        np.linspace(0.0, length, elements[0] + 1), np.linspace(0.0, width, elements[1] + 1)
    )
    basis = skfem.Basis(mesh, skfem.ElementQuadBFS(), intorder=6)
    names = {"w": (), "wx": (0,), "wy": (1,), "wxx": (0, 0), "wyy": (1, 1), "wxy": (0, 1)}
    return Fields((Component(basis, 0, names),), 2)
