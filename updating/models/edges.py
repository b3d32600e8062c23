"""What a clamped edge of a plate holds along its length, and the shapes that appear where a part of it lets go.

An edge that rotates, or shifts, along a stretch moves by a function that is nil elsewhere on the edge. Such functions
lie among those that the mesh has along the edge, of which the smoothest are kept. Each comes with the static answer of
the plate to it, so that with the modes of the clamped plate they make the basis of Craig and Bampton (AIAA J. 6 (1968)
1313-1319).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import eigh
from scipy.sparse.linalg import splu

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Component, Fields, Sparse
from updating.models.spec import Spec
from updating.models.structure import FieldStructure

Kind = Literal["rotation", "translation"]

SMOOTHEST = 42
"""Most functions kept along an edge, those of twenty elements [-]: a stretch then ends within a twentieth of the edge,
and half an edge without any stiffness gives way within 2 %. With half as many: 6 %."""

SHARED = 96
"""Most functions kept of one kind along all clamped edges together [-]: twice as many cost four times the memory."""

POINTS = 5
"""Gauss points in every element along an edge: exact for the product of two quintics [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """The functions by which a clamped edge may move where it lets go, orthonormal along the edge.

    Parameters
    ----------
    component : Component
        Field that moves: of a thin plate the displacement.
    name : str
        Which of its values: ``wx`` is the slope across an edge of constant x.
    edge : str
        The edge.
    dofs : (n,) int array
        Degrees of freedom that the edge alone holds and that make it move so.
    shapes : (n, m) array
        The functions, by these degrees of freedom.
    n_dofs : int
        Of the whole model.
    lines : (k,) array
        Where elements end along the edge [m].
    across : float
        Where the edge is, along its normal [m].
    """

    component: Component
    name: str
    edge: str
    dofs: IntArray
    shapes: FloatArray
    n_dofs: int
    lines: FloatArray
    across: float

    @property
    def size(self) -> float:
        """Length of the edge [m]."""
        return float(self.lines[-1] - self.lines[0])

    def rows(self, along: FloatArray) -> Sparse:
        """Return the motion at places along the edge (k,) [m], (k, n_dofs)."""
        return _rows(self.component, self.name, self.edge, self.across, along, self.n_dofs)

    def at(self, along: FloatArray) -> FloatArray:
        """Return the functions at places along the edge (k,) [m], (k, m)."""
        return np.asarray(self.rows(along)[:, self.dofs] @ self.shapes)

    def coefficients(self) -> tuple[Sparse, Sparse]:
        """Return the functions' coefficients in the edge's motion (m, n_dofs), and the integral of its square."""
        along, weights = gauss_points(self.lines)
        rows = self.rows(along)
        weighted = Sparse(rows.multiply(weights[:, None]))
        return Sparse(self.at(along).T @ weighted), Sparse(rows.T @ weighted)


def released_along(kind: Kind, edge: str) -> str:
    """Return what a state calls a clamped edge that a part of lets go."""
    return f"{kind} {edge}"


def gauss_points(lines: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Gauss points between lines (k,) and their weights, each (POINTS (k - 1),) [m]."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    middle, half = (lines[1:] + lines[:-1]) / 2, np.diff(lines) / 2
    return (middle[:, None] + nodes * half[:, None]).ravel(), (weights * half[:, None]).ravel()


def trace(structure: FieldStructure, released: str) -> Trace:
    """Return the functions by which an edge may move, named as :func:`released_along` does."""
    spec, fields = structure.spec, structure.fields
    kind, edge = released.split()
    component, name, slope = _field(spec, fields, kind, edge)
    mesh = component.basis.mesh
    lines = np.unique(np.round(mesh.p[1 if edge[0] == "x" else 0], 12))
    across = {"x0": 0.0, "x1": spec.length, "y0": 0.0, "y1": spec.width}[edge]
    along, weights = gauss_points(lines)
    place = component, name, edge, across, along, fields.n_dofs
    rows = _rows(*place)[:, structure.along[released]].toarray()
    moving = np.abs(rows).max(axis=0) > 0
    dofs, rows = structure.along[released][moving], rows[:, moving]
    slopes = _rows(component, slope, edge, across, along, fields.n_dofs)[:, dofs].toarray()
    most = min(SMOOTHEST, SHARED // len(spec.clamped))
    # in lengths of the edge: slopes of the functions over themselves
    stiff, own = (each.T @ (weights[:, None] * each) for each in (slopes, rows))
    _, shapes = eigh(stiff, own, subset_by_index=(0, min(most, len(dofs)) - 1))
    return Trace(
        component=component,
        name=name,
        edge=edge,
        dofs=dofs,
        shapes=shapes,
        n_dofs=fields.n_dofs,
        lines=lines,
        across=across,
    )


def static_lifts(structure: FieldStructure, released: str) -> FloatArray:
    """Return the static answers of the clamped plate to an edge that moves by each of its functions, (n_dofs, m)."""
    one = trace(structure, released)
    free = np.setdiff1d(structure.free(frozenset({released})), one.dofs)
    stiffness = structure.matrix("stiffness")
    found = np.zeros((structure.n_dofs, one.shapes.shape[1]))
    found[one.dofs] = one.shapes
    found[free] = -splu(stiffness[free][:, free].tocsc()).solve(stiffness[free] @ found)
    return found


def _field(spec: Spec, fields: Fields, kind: str, edge: str) -> tuple[Component, str, str]:
    """Return which field moves, the name of its value across an edge, and that of its slope along the edge."""
    normal, tangent = ("x", "y") if edge[0] == "x" else ("y", "x")
    if kind == "translation":
        return fields.components[0], "w", f"w{tangent}"
    if spec.theory == "mindlin":
        return fields.components[1 + "xy".index(normal)], f"t{normal}", f"t{normal}{tangent}"
    return fields.components[0], f"w{normal}", "wxy"


def _rows(
    component: Component, name: str, edge: str, across: float, along: FloatArray, n_dofs: int
) -> Sparse:
    """Return a value of a field at places along an edge (k,) [m], (k, n_dofs)."""
    fixed = np.full(len(along), across)
    points = np.stack([fixed, along] if edge[0] == "x" else [along, fixed], axis=1)
    if "w" in component.names:
        return component.hermite(points, n_dofs, {name: tuple("xy".index(axis) for axis in name[1:])})[name]
    return component.at(points, n_dofs)[name]
