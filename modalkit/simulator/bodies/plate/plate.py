"""The rig's plate: Reissner-Mindlin, rotary inertia, quintic elements on an uneven grid.

It shares no code with the models of the candidates, which are thin plates of cubic elements.

What a scene needs of it, as of the beam (``body.Body``):

* ``start`` and ``end`` are the edges x0 and x1, ``side`` is y0 and y1 is ``side + width``. A plate clamped at x0
  grows by its ``start``; its test points stay where they are. All fields may be changed by
  ``dataclasses.replace``; those that a beam has too have the same names and meaning (``clamped``,
  ``clamp_rotation``, ``clamp_translation`` (here per metre of edge), ``taper``, ``axial``, ``fluid_density``,
  ``drag``, ``attached``, ``absorbers``, ``alpha``, ``beta``, ``added_alpha``, ``added_beta``, ``added_loss``).
* ``real_modes(count)`` gives omega and mass-normalised shapes in all DOFs: w, theta_x, theta_y of each node,
  then one for every mass that hangs.
* ``rows(places, quantity)`` takes places of shape (n, 2) and reads ``w``, the slopes ``slope_x`` and
  ``slope_y``, or the rotations ``theta_x`` and ``theta_y``. Places beyond an edge are extrapolated.
* ``modal_damping(shapes)`` and ``modal_losses(shapes)`` as the beam's.
* In ``plate_parts``: ``attached`` holds ``PlateAttached(x, y, mass, inertia, stiffness, damping)``,
  ``absorbers`` ``PlateAbsorber(x, y, mass, stiffness, damping)``, ``spots`` ``SoftSpot(x, y, extent, across, loss,
  smooth)``, ``patches`` ``Patch(x, y, extent, across, loss_factor, mass, stiffness)`` (a layer, or with loss_factor 0
  a thicker or thinner rectangle), ``ribs`` ``Rib`` or what ``flat_rib`` returns.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import scipy.sparse

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.bodies.plate import edges as plate_edges
from modalkit.simulator.bodies.plate import matrices as plate_matrices
from modalkit.simulator.bodies.plate.fields import PlateFields
from modalkit.simulator.bodies.plate.matrices import Sparse
from modalkit.simulator.bodies.plate.panel import Wetted, wetted
from modalkit.simulator.bodies.plate.parts import PlateAbsorber, PlateAttached
from modalkit.simulator.bodies.plate.solve import lowest_modes

_BASIS = 16
"""Modes beyond those wanted, between which stiffness that spans the whole plate is put in; twice as many move the
frequencies by less than 1e-4 and cost half as much again."""


@dataclass(frozen=True)
class Plate(PlateFields):
    """A rectangular plate that moves in the direction of its thickness; fields as in ``PlateFields``."""

    @property
    def n_dofs(self) -> int:
        """Degrees of freedom: three a node, one for every mass that hangs, one for a cavity's neck [-]."""
        return 3 * self.grid.count + len(self._hanging)

    @property
    def _hanging(self) -> list[float]:
        """Masses of the DOFs that are no node's: those that hang, and the air in a neck [kg], [kg/m4]."""
        neck = [] if self.cavity is None else [self.cavity.inertance]
        return [p.mass for p in self.absorbers] + neck

    @cached_property
    def _coupled_rows(self) -> FloatArray:
        """Rows whose squares are stiffness that spans the whole plate: of a cavity, of an arch."""
        _, _, weight, read = self.grid.gauss
        rows = []
        if self.cavity is not None:
            row = read.rows({0: read.value}, self.n_dofs).T @ weight
            row[-1] -= 1.0
            rows.append(np.sqrt(self.cavity.stiffness) * row)
        if self.rise:
            at = self.middled(self.points[0]) + 0.5
            slope = np.pi * self.rise / self.length * np.sin(2 * np.pi * at)
            stiffness = self.E * self.thickness / (1 - self.poisson**2) / self.length / self.width
            rows.append(np.sqrt(stiffness) * (read.rows({0: read.dx}, self.n_dofs).T @ (weight * slope)))
        return np.array(rows).reshape(len(rows), self.n_dofs)

    @cached_property
    def _layers(self) -> tuple[Sparse, ...]:
        """Bending stiffness of the bare plate under each patch."""
        return tuple(
            plate_matrices.stiffness_matrix(self.grid, self.under(p), shear=False) for p in self.patches
        )

    @cached_property
    def _ribs(self) -> tuple[tuple[Sparse, Sparse], ...]:
        return tuple(plate_matrices.rib_matrices(self.grid, rib) for rib in self.ribs)

    @cached_property
    def _material_stiffness(self) -> Sparse:
        whole = plate_matrices.stiffness_matrix(self.grid, self.section)
        for patch, layer in zip(self.patches, self._layers, strict=True):
            whole = whole + patch.stiffness * layer
        for stiffness, _ in self._ribs:
            whole = whole + stiffness
        return whole.tocsr()

    @cached_property
    def _material_mass(self) -> Sparse:
        whole = plate_matrices.mass_matrix(self.grid, *self.inertia())
        for _, mass in self._ribs:
            whole = whole + mass
        return whole.tocsr()

    def _relative_rows(self, part: str) -> Sparse:
        """Read what springs (``stiffness``) or dashpots (``damping``) feel, times the root of their constants."""
        fixed: tuple[PlateAttached | PlateAbsorber, ...] = (*self.attached, *self.absorbers)
        rows = self._sparse_rows(np.array([(p.x, p.y) for p in fixed]).reshape(-1, 2), "w")
        hung = np.arange(len(self.absorbers))
        where = len(self.attached) + hung, 3 * self.grid.count + hung
        rows = rows - scipy.sparse.coo_array((np.ones(len(hung)), where), shape=rows.shape)
        roots = scipy.sparse.diags_array([np.sqrt(getattr(p, part)) for p in fixed])
        return Sparse(roots @ rows)

    def _stiffness(self) -> Sparse:
        """Of the material, loads, edges and springs."""
        whole = self._material_stiffness
        if self.axial or self.axial_across:
            whole = whole + plate_matrices.load_matrix(self.grid, self.load, self.axial_across / self.length)
        springs = {"shift": self.clamp_translation, "turn": self.clamp_rotation}
        edges = plate_edges.edge_springs(self.grid, self.clamped, **springs, stretch=self.gives_way)
        whole = self._padded(whole + edges)
        if self.attached or self.absorbers:
            rows = self._relative_rows("stiffness")
            whole = whole + rows.T @ rows
        return whole.tocsr()

    def _mass(self) -> Sparse:
        """Of the material and of what is fixed or hangs, without the fluid's."""
        whole = self._material_mass
        if self.attached:
            whole = whole + plate_matrices.attached_mass(self.grid, self.attached)
        return self._padded(whole, self._hanging)

    def _padded(self, matrix: Sparse, last: list[float] | None = None) -> Sparse:
        if not self._hanging:
            return matrix.tocsr()
        rest = scipy.sparse.diags_array(last or [0.0] * len(self._hanging))
        return Sparse(scipy.sparse.block_diag([matrix, rest], format="csr"))

    @cached_property
    def _wet(self) -> Wetted:
        return wetted(
            (self.start, self.end),
            (self.side, self.side + self.width),
            self.thickness,
            wall=self.wall and set(self.clamped) == {"x0"},
            tank=(self.free_surface, self.bottom),
        )

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what damps some modes: the material as expected, and what else is viscous; as of :class:`Body`."""
        nodal = shapes[: 3 * self.grid.count]
        stiffness = nodal.T @ (self._material_stiffness @ nodal)
        material = self.alpha * nodal.T @ (self._material_mass @ nodal) + self.beta * stiffness
        others = self.added_alpha * np.eye(shapes.shape[1]) + self.added_beta * stiffness
        if self.attached or self.absorbers:
            moved = self._relative_rows("damping") @ shapes
            others = others + moved.T @ moved
        if self.cavity is not None:
            others = others + self.cavity.resistance * np.outer(shapes[-1], shapes[-1])
        return material, others

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return structural damping of the whole and of layers, and a fluid's boundary layer; as of :class:`Body`."""
        nodal, losses = shapes[: 3 * self.grid.count], []
        if self.added_loss:
            losses.append(Loss(self.added_loss * nodal.T @ (self._material_stiffness @ nodal), -1.0))
        for patch, layer in zip(self.patches, self._layers, strict=True):
            if patch.loss_factor:
                factor = patch.loss_factor * (1.0 + patch.stiffness)
                losses.append(Loss(factor * nodal.T @ (layer @ nodal), -1.0))
            if patch.beta:
                factor = patch.beta * (1.0 + patch.stiffness)
                losses.append(Loss(factor * nodal.T @ (layer @ nodal), 0.0))
            if patch.alpha:
                under = plate_matrices.mass_matrix(self.grid, *self.mass_under(patch))
                losses.append(Loss(patch.alpha * nodal.T @ (under @ nodal), 0.0))
        if self.drag:
            moved = self._sparse_rows(self._wet.places, "w") @ shapes
            losses.append(Loss(np.sqrt(self.drag / 2) * self._wet.slip(moved), 0.5, inertia=True))
        return tuple(losses)

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows that read the deflection, its slopes or the rotations at places.

        Parameters
        ----------
        places : (n, 2) array
            Positions [m].
        quantity : {"w", "slope_x", "slope_y", "theta_x", "theta_y"}
            What to read.

        Returns
        -------
        (n, n_dofs) array
            Rows to multiply with a vector of DOFs.
        """
        return np.asarray(self._sparse_rows(np.asarray(places, float), quantity).toarray())

    def _sparse_rows(self, places: FloatArray, quantity: str) -> Sparse:
        x, y = places.T
        read = self.grid.read(self.grid.find(x, y), y)
        field, values = {
            "w": (0, read.value),
            "slope_x": (0, read.dx),
            "slope_y": (0, read.dy),
            "theta_x": (1, read.value),
            "theta_y": (2, read.value),
        }[quantity]
        return read.rows({field: values}, self.n_dofs)

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes, in all DOFs; as of :class:`Body`.

        Notes
        -----
        Stiffness that spans the whole plate would fill its sparse matrix; it is put in between the lowest
        modes without it, some more than are wanted.
        """
        if not len(self._coupled_rows):
            return self._local_modes(count)
        omega, shapes = self._local_modes(count + _BASIS)
        moved = self._coupled_rows @ shapes
        values, mixed = scipy.linalg.eigh(np.diag(omega**2) + moved.T @ moved)
        return np.sqrt(np.maximum(values[:count], 0.0)), shapes @ mixed[:, :count]

    def _local_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the modes without what spans the whole plate."""
        free = {"shift": np.isfinite(self.clamp_translation), "turn": np.isfinite(self.clamp_rotation)}
        motions = plate_edges.free_motions(self.grid, self.clamped, **free, stretch=self.gives_way)
        kept = self._padded(motions, [1.0] * len(self._hanging))
        added = None
        if self.fluid_density:
            rows = self._sparse_rows(self._wet.places, "w") @ kept
            matrix = self.fluid_density * self._wet.matrix

            def added(columns: FloatArray) -> FloatArray:
                return np.asarray(rows.T @ (matrix @ (rows @ columns)))

        line = self.density * self.thickness * max(self.length, self.width) ** 4
        omega, vectors = lowest_modes(
            kept.T @ self._stiffness() @ kept,
            kept.T @ self._mass() @ kept,
            count=count,
            shift=self.bending_stiffness / line,
            added=added,
        )
        return omega, np.asarray(kept @ vectors)
