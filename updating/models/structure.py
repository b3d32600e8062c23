"""A beam or plate as a sum of energy terms over regions.

Paper A, Eqs. 11-14, and paper B, Eqs. 1 and 3, divide the model in regions whose matrices are summed.
Here every matrix is a sum of *terms*: two fields, a coefficient at each quadrature point, and the power with
which the term grows with modulus, density, thickness, width and length. So K and M are exact for any change
of these, and their logarithmic sensitivities are the powers themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np
from scipy import sparse

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.base import Structure
from updating.models.fields import (
    Fields,
    Sparse,
    beam_fields,
    mindlin_fields,
    plate_fields,
    timoshenko_fields,
)
from updating.models.parts import Region
from updating.models.spec import Spec
from updating.models.state import State
from updating.models.terms import FieldTerm, beam_terms, plate_terms, product

STIFFER_ACROSS = (0.1, 10.0)
"""Stiffness of plates across over that along, of which the basis has the shapes [-]: in between, frequencies of
thin plates are right to 3e-4. Without them, 2 % are missing at 10."""


MOST_CELLS = 40
"""So many cells a beam has at most: of ten modes a soft stretch is right to per cents of its shift."""


RESOLVED = 32
"""About so many elements along a side resolve soft places of an eighth of it: their shifts are right to some 6 %, and
to 14 % on half as many."""


@dataclass(frozen=True, eq=False)
class FieldStructure(Structure):
    """A finite-element model of a beam or a plate, ready to be reduced or solved.

    Parameters
    ----------
    spec : Spec
        What it is a model of.
    fields : Fields
        Its fields.
    terms : tuple of FieldTerm
        Its stiffness and mass.
    region_of : (n_points,) int array
        Region in which each quadrature point lies, -1 for none.
    fixed : mapping of str to int array
        Degrees of freedom that a clamp holds: its ``translation`` and its ``rotation``.
    along : mapping of str to int array
        Of plates those that one clamped edge alone holds, by kind and edge: ``rotation x0``.
    """

    spec: Spec
    fields: Fields
    terms: tuple[FieldTerm, ...]
    region_of: IntArray
    fixed: Mapping[str, IntArray] = field(default_factory=lambda: MappingProxyType({}))
    along: Mapping[str, IntArray] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom before any is fixed."""
        return self.fields.n_dofs

    def matrix(self, kind: str, weights: FloatArray | float = 1.0) -> Sparse:
        """Assemble the stiffness or mass matrix over all degrees of freedom [SI].

        Parameters
        ----------
        kind : {"stiffness", "mass"}
            Which one.
        weights : (n_points,) array or float
            Factor on the coefficient at every quadrature point [-]; masks give region matrices.
        """
        n = self.fields.n_dofs
        total = Sparse((n, n))
        for term in self.terms:
            if term.kind == kind:
                left, right = self.fields.sampled[term.left], self.fields.sampled[term.right]
                part = left.T @ sparse.diags_array(term.coefficient * weights) @ right
                total = total + (part if term.left == term.right else (part + part.T) / 2)
        if kind == "mass":
            total = total + self.point_masses()
        return Sparse(total)

    def point_masses(self) -> Sparse:
        """Assemble the masses stated by the modeller [kg in w]."""
        n = self.fields.n_dofs
        total = Sparse((n, n))
        for mass in self.spec.masses:
            rows = self.fields.at(np.array([mass.at[: self.fields.dim]]))
            total = total + mass.mass * (rows["w"].T @ rows["w"])
            for slope in ("wx", "wy"):
                if mass.inertia and slope in rows:
                    total = total + mass.inertia * (rows[slope].T @ rows[slope])
        return total

    def matrices(self, state: State) -> tuple[Sparse, Sparse]:
        """Return stiffness and mass under a state's factors, of the whole and of regions, Eqs. 11-14 [SI]."""
        n = self.n_dofs
        total = {"stiffness": Sparse((n, n)), "mass": self.point_masses()}
        for term in self.terms:
            weights = term.coefficient * term.scale(state.factors)
            for (region, factor), value in state.regional.items():
                inside = self.region_of == region
                weights = np.where(inside, weights * value ** term.powers.get(factor, 0.0), weights)
            part = self.fields.sampled[term.left].T @ (self.fields.sampled[term.right] * weights[:, None])
            total[term.kind] = total[term.kind] + (part if term.left == term.right else (part + part.T) / 2)
        return Sparse(total["stiffness"]), Sparse(total["mass"])

    def region_products(self, basis: FloatArray) -> tuple[FloatArray, ...]:
        """Return every term on a basis, each (n_regions + 1, r, r); the last is what lies in no region [SI]."""
        count = len(self.spec.regions)
        sampled = {name: np.asarray(field @ basis) for name, field in self.fields.sampled.items()}
        masks = [np.flatnonzero(self.region_of == (i if i < count else -1)) for i in range(count + 1)]
        return tuple(np.stack([product(t, sampled, rows) for rows in masks]) for t in self.terms)

    def rows(self, points: FloatArray, directions: FloatArray | None = None) -> dict[str, Sparse]:
        """Return displacement ``w`` along z and slopes at points (n_points, dim), each (n_points, n_dofs)."""
        return self.fields.at(points)

    def rows_on(
        self, points: FloatArray, directions: FloatArray | None, basis: FloatArray
    ) -> dict[str, FloatArray]:
        """Return the same on a basis (n_dofs, r), each (n_points, r)."""
        return self.fields.on(points, basis)

    def unit_mass(self, points: FloatArray) -> Sparse:
        """Return the mass matrix of 1 kg at each of some points [kg in w]."""
        rows = self.fields.at(points)["w"]
        return Sparse(rows.T @ rows)

    @cached_property
    def cells(self) -> FloatArray:
        """Ends of the cells in each of which a beam bends as it likes, (n + 1,) [m]: its elements, or groups of them.

        No group reaches over the end of a region.
        """
        elements, length = self.spec.elements[0], self.spec.length
        groups = np.linspace(0, elements, min(elements, MOST_CELLS) + 1)
        regions = [end / length * elements for region in self.spec.regions for end in region.x]
        ends = np.unique(np.clip(np.round([*groups, *regions]), 0, elements).astype(int))
        return np.asarray(np.linspace(0.0, length, elements + 1)[ends])

    @cached_property
    def cell_of(self) -> IntArray:
        """Cell in which each quadrature point of a beam lies, (n_points,)."""
        return self.in_cells(self.fields.points[:, 0])[0]

    @cached_property
    def within_cell(self) -> FloatArray:
        """Where in its cell each lies, from -1 to 1, (n_points,) [-]."""
        return self.in_cells(self.fields.points[:, 0])[1]

    def in_cells(self, places: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the cell of a beam in which each place (n,) [m] lies, and where in it, from -1 to 1 [-]."""
        ends = self.cells
        cell = np.clip(np.searchsorted(ends, places, side="right") - 1, 0, len(ends) - 2)
        low, high = ends[cell], ends[cell + 1]
        return cell, np.asarray((2 * places - low - high) / (high - low))

    @cached_property
    def finer(self) -> FieldStructure:
        """A thin plate on elements that divide its own and resolve soft places; itself where there is no need."""
        spec = self.spec
        elements = tuple(n * max(round(RESOLVED / n), 1) for n in spec.elements)
        if spec.kind != "plate" or spec.theory != "kirchhoff" or elements == spec.elements:
            return self
        return build_field_structure(spec.with_elements(*elements))

    def softenings(self, elastic: FloatArray) -> FloatArray:
        """Return the loads that a softened place feels: moments per element of a beam, modal forces per region."""
        if self.fields.dim == 1:
            bending = self.terms[0]
            loaded = self.fields.sampled[bending.left].T @ sparse.diags_array(bending.coefficient)
            at = np.arange(loaded.shape[1])
            return np.hstack(
                [
                    (loaded @ sparse.coo_array((shape, (at, self.cell_of)))).toarray()
                    for shape in (np.ones(len(at)), self.within_cell)
                ]
            )
        low = elastic[:, : min(4, elastic.shape[1])]
        masks = [(self.region_of == index).astype(float) for index in range(len(self.spec.regions))]
        return np.hstack([self.matrix("stiffness", mask) @ low for mask in masks])

    @property
    def stretched(self) -> tuple[State, ...]:
        """A plate a tenth and ten times as stiff across as along, which bends like one that is wider or narrower.

        The energy of bending across goes with width^-3, that along with width, that of twist and the mass between.
        """
        if self.fields.dim == 1:
            return ()
        return tuple(State(factors={"width": ratio**-0.25}) for ratio in STIFFER_ACROSS)

    @cached_property
    def rigid_modes(self) -> int:
        """Number of rigid-body modes that the clamps leave."""
        if self.fixed:
            return 0
        return 2 if self.fields.dim == 1 else 3

    def region_mask(self, region: Region) -> BoolArray:
        """Return which quadrature points lie in a region, shape (n_points,)."""
        return region_mask(region, self.fields.points)


def regions_at(spec: Spec, points: FloatArray) -> IntArray:
    """Return the region in which each of some points (n_points, dim) [m] lies, of several the last; -1 is none."""
    found = np.full(len(points), -1)
    for index, region in enumerate(spec.regions):
        found[region_mask(region, points)] = index
    return found


def region_mask(region: Region, points: FloatArray) -> BoolArray:
    """Return which points (n_points, dim) [m] lie in a region, shape (n_points,)."""
    inside = (points[:, 0] >= region.x[0]) & (points[:, 0] <= region.x[1])
    if region.y is not None and points.shape[1] > 1:
        inside &= (points[:, 1] >= region.y[0]) & (points[:, 1] <= region.y[1])
    return np.asarray(inside)


def build_field_structure(spec: Spec) -> FieldStructure:
    """Build the finite-element model of a beam or plate.

    Raises
    ------
    StudyError
        If a region lies off the structure.
    """
    if spec.kind == "plate":
        size = spec.length, spec.width, (spec.elements[0], spec.elements[1])
        thin = spec.theory == "kirchhoff"
        fields = plate_fields(*size) if thin else mindlin_fields(*size, spec.thickness)
    elif spec.theory == "timoshenko":
        fields = timoshenko_fields(spec.length, spec.elements[0])
    else:
        fields = beam_fields(spec.length, spec.elements[0])
    for region in spec.regions:
        if not region_mask(region, fields.points).any():
            raise StudyError(
                f"region {region.name!r} holds no part of the model; check its x and y, or use more elements"
            )
    region_of = regions_at(spec, fields.points)
    terms = (
        plate_terms(spec, fields, region_of) if spec.kind == "plate" else beam_terms(spec, fields, region_of)
    )
    return FieldStructure(
        spec, fields, terms, region_of, clamped_dofs(spec, fields), dofs_along(spec, fields)
    )


def clamped_dofs(spec: Spec, fields: Fields) -> Mapping[str, IntArray]:
    """Sort the degrees of freedom of the clamped edges into what holds translation and what rotation."""
    if not spec.clamped:
        return MappingProxyType({})
    edges = [_held_by(spec, fields, edge) for edge in spec.clamped]
    return MappingProxyType(
        {kind: np.unique(np.concatenate([edge[kind] for edge in edges])) for kind in edges[0]}
    )


def dofs_along(spec: Spec, fields: Fields) -> Mapping[str, IntArray]:
    """Return which degrees of freedom each clamped edge of a plate alone holds, by ``"rotation x0"`` and the like."""
    if spec.kind != "plate":
        return MappingProxyType({})
    own = {
        f"{kind} {edge}": dofs for edge in spec.clamped for kind, dofs in _held_by(spec, fields, edge).items()
    }
    found = {}
    for name, dofs in own.items():
        others = [np.zeros(0, dtype=dofs.dtype), *(held for other, held in own.items() if other != name)]
        found[name] = np.setdiff1d(dofs, np.concatenate(others))
    return MappingProxyType(found)


def _held_by(spec: Spec, fields: Fields, edge: str) -> dict[str, IntArray]:
    """Return the degrees of freedom by which a clamped edge holds translation, and those by which rotation."""
    held: dict[str, list[IntArray]] = {"translation": [], "rotation": []}
    shears = spec.theory in ("timoshenko", "mindlin")
    axis, end = "xy".index(edge[0]), int(edge[1])
    normal = "u_x" if axis == 0 else "u_y"
    for number, component in enumerate(fields.components):
        place = component.basis.mesh.p[axis].max() if end else component.basis.mesh.p[axis].min()
        found = component.basis.get_dofs(lambda p, a=axis, at=place: np.isclose(p[a], at))
        for name, dofs in [*found.nodal.items(), *found.facet.items()]:
            if number == 0 and shears and name in (normal, "u_xy"):
                continue  # the slope of the displacement across a clamp is the shear strain there, and free
            turns = number == 1 + axis if number else name in (normal, "u_xy")
            held["rotation" if turns else "translation"].append(np.asarray(dofs) + component.offset)
    return {kind: np.unique(np.concatenate(dofs)) for kind, dofs in held.items()}
