"""The rig's beam: fine, non-uniform, with shear and rotary inertia, and with what is fixed to it.

It shares no code with the models of the candidates. Shear coefficient: Cowper, J. Appl. Mech. 33 (1966) 335,
rectangular section, 10 (1 + nu) / (12 + 11 nu).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.beam.fields import STIFF, BeamFields
from modalkit.simulator.bodies.beam.water import added_mass, layer_damping
from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.bodies.element import NODES, ORDER, readers

_BASIS = 30


@dataclass(frozen=True)
class Beam(BeamFields):
    """A beam that moves in the direction of its thickness; fields as in ``BeamFields``."""

    @cached_property
    def _strain_rows(self) -> FloatArray:
        """F with F^T F the stiffness of the material [sqrt(N/m)]."""
        x, read = self.gauss
        shear = self.shear_modulus * self.width * self.thickness_at(x)
        bend, slide = read["curvature"], read["slope"] - read["theta"]
        return np.vstack([self.spread(bend, self.bending), self.spread(slide, shear)])

    @cached_property
    def _line(self) -> FloatArray:
        """Mass per length at the Gauss points [kg/m]."""
        x, _ = self.gauss
        t = self.thickness_at(x)
        line: FloatArray = self.density * self.width * t * (1.0 + self.density_slope * self.middled(x))
        for part in self.stretches:
            line = line * (1.0 + (part.line - 1.0) * part.inside(x))
        return line

    @cached_property
    def _material_mass(self) -> FloatArray:
        x, read = self.gauss
        line, t = self._line, self.thickness_at(x)
        rotary = line * t**2 / 12 / (1.0 if self.shear else STIFF)
        move, turn = self.spread(read["w"], line), self.spread(read["theta"], rotary)
        mass: FloatArray = move.T @ move + turn.T @ turn
        return mass

    def _whole_mass(self) -> FloatArray:
        mass = self._material_mass.copy()
        for part in self.attached:
            here, turn = self._row(part.x, "w"), self._row(part.x, "theta")
            mass += part.mass * np.outer(here, here) + part.inertia * np.outer(turn, turn)
        for k, hanging in enumerate(self.absorbers):
            mass[2 * len(self.nodes) + k, 2 * len(self.nodes) + k] = hanging.mass
        if self.fluid_density:
            size, tank = (self.length, self.width, self.thickness), (self.free_surface, self.bottom)
            stations, matrix = added_mass(*size, density=self.fluid_density, tank=tank)
            rows = self.rows(self.start + stations, "w")
            mass += rows.T @ matrix @ rows
        return mass

    def _relative_row(self, k: int) -> FloatArray:
        """Read by how much a hanging mass moves against the beam."""
        row = self._row(self.absorbers[k].x, "w")
        row[2 * len(self.nodes) + k] -= 1.0
        return row

    def _spring_rows(self) -> FloatArray:
        rows = [np.sqrt(p.stiffness) * self._row(p.x, "w") for p in self.attached if p.stiffness]
        rows += [np.sqrt(h.stiffness) * self._relative_row(k) for k, h in enumerate(self.absorbers)]
        rows += [self._arch_row] if self.rise else []
        for end in self.clamped:
            x = self.start if end == "x0" else self.end
            for stiffness, quantity in ((self.clamp_translation, "w"), (self.clamp_rotation, "theta")):
                if np.isfinite(stiffness):
                    rows.append(np.sqrt(stiffness) * self._row(x, quantity))
        return np.array(rows).reshape(len(rows), self.n_dofs)

    @cached_property
    def _tension_rows(self) -> FloatArray:
        """G with G^T G the geometric stiffness of the load's size [sqrt(N/m)]."""
        x, read = self.gauss
        load = abs(self.axial) * (1.0 + 2 * self.axial_lean * self.middled(x))
        return self.spread(read["slope"], load)

    @cached_property
    def _arch_row(self) -> FloatArray:
        """Read the stretching of a shallow arch, times the root of E A / L [sqrt(N/m)].

        Its thrust is the same all along: E A / L times the integral of w0' w' (linearised; Lacarbonara and Rega,
        Int. J. Non-Linear Mechanics 38 (2003) 873). One row of F, whose shape (1 - cos(2 pi x / L)) / 2 is that
        of a beam clamped at both ends.
        """
        x, read = self.gauss
        slope = np.pi * self.rise / self.length * np.sin(2 * np.pi * (self.middled(x) + 0.5))
        shifted = np.zeros(self.n_dofs)
        shifted[: 2 * len(self.nodes) : 2] = 1.0
        roots = self.spread(read["w"], np.ones_like(x)) @ shifted
        stiffness = self.E * self.width * self.thickness / self.length
        row: FloatArray = (
            np.sqrt(stiffness) * self.spread(read["slope"], np.ones_like(x)).T @ (roots * slope.ravel())
        )
        return row

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what damps some modes: the material as expected, and what else is viscous; as of :class:`Body`."""
        strain = self._strain_rows @ shapes
        stiffness = strain.T @ strain
        material = self.alpha * shapes.T @ self._material_mass @ shapes + self.beta * stiffness
        others = self.added_alpha * np.eye(shapes.shape[1]) + self.added_beta * stiffness
        rows = [np.sqrt(p.damping) * self._row(p.x, "w") for p in self.attached if p.damping]
        rows += [np.sqrt(h.damping) * self._relative_row(k) for k, h in enumerate(self.absorbers)]
        moved = np.array(rows).reshape(len(rows), self.n_dofs) @ shapes
        return material, others + moved.T @ moved

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return structural damping of the whole and of layers, and a fluid's boundary layer; as of :class:`Body`."""
        losses = []
        if self.added_loss:
            strain = self._strain_rows @ shapes
            losses.append(Loss(self.added_loss * strain.T @ strain, -1.0))
        x, read = self.gauss
        for part in self.stretches:
            if part.loss or part.beta:
                strain = self.spread(read["curvature"], self.bending * part.inside(x)) @ shapes
                losses.append(Loss(part.loss * strain.T @ strain, -1.0))
                losses.append(Loss(part.beta * strain.T @ strain, 0.0))
            if part.alpha:
                moved = self.spread(read["w"], self._line * part.inside(x)) @ shapes
                losses.append(Loss(part.alpha * moved.T @ moved, 0.0))
        if self.drag:
            stations, matrix = layer_damping(self.length, self.width, self.thickness, drag=self.drag)
            moved = self.rows(self.start + stations, "w") @ shapes
            losses.append(Loss(moved.T @ matrix @ moved, 0.5, inertia=True))
        return tuple(losses)

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows that read the deflection ``w``, its ``slope`` or the rotation ``theta`` at places.

        Parameters
        ----------
        places : (n,) or (n, 1) array
            Positions; what lies off the beam is read at its end [m].
        quantity : {"w", "slope", "theta", "curvature"}
            What to read.

        Returns
        -------
        (n, n_dofs) array
            Rows to multiply with a vector of DOFs.
        """
        x = np.clip(np.asarray(places, float).reshape(-1), self.edges[0], self.edges[-1])
        element = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        size = np.diff(self.edges)[element]
        local = readers((x - self.edges[element]) / size, size)[quantity]
        out = np.zeros((len(x), self.n_dofs))
        np.put_along_axis(out, 2 * ORDER * element[:, None] + np.arange(2 * NODES), local, axis=1)
        return out

    def _row(self, x: float, quantity: str) -> FloatArray:
        row: FloatArray = self.rows(np.array([x]), quantity)[0]
        return row

    @cached_property
    def _kept(self) -> FloatArray:
        """Indices of the DOFs that no rigid clamp holds."""
        last = 2 * len(self.nodes) - 2
        held = [
            dof + turn
            for dof in [{"x0": 0, "x1": last}[end] for end in self.clamped]
            for turn, stiffness in enumerate((self.clamp_translation, self.clamp_rotation))
            if not np.isfinite(stiffness)
        ]
        return np.setdiff1d(np.arange(self.n_dofs), held)

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes, in all DOFs; as of :class:`Body`.

        Notes
        -----
        With stiffness F^T F and mass L L^T the frequencies are the singular values of F L^-T, whose rounding
        is that of the highest frequency; the eigenvalues of the products would lose the lowest modes of
        slender beams (Golub and Van Loan, Matrix Computations, 4th ed., section 8.7). Thrust, whose stiffness
        is negative, is then put in between the lowest of these modes.
        """
        keep = self._kept
        factor = scipy.linalg.cholesky(self._whole_mass()[np.ix_(keep, keep)], lower=True)
        parts = [self._strain_rows, self._spring_rows()]
        if self.axial > 0:
            parts.append(self._tension_rows)
        scaled = scipy.linalg.solve_triangular(factor, np.vstack(parts)[:, keep].T, lower=True).T
        _, omega, vectors = scipy.linalg.svd(scaled, full_matrices=False)
        wanted = count + _BASIS if self.axial < 0 else count
        omega, lowest = omega[::-1][:wanted], vectors[::-1][:wanted]
        shapes = np.zeros((self.n_dofs, len(omega)))
        shapes[keep] = scipy.linalg.solve_triangular(factor, lowest.T, lower=True, trans="T")
        return self._thrust(omega, shapes, count) if self.axial < 0 else (omega, shapes)

    def _thrust(self, omega: FloatArray, shapes: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        slopes = self._tension_rows @ shapes
        values, vectors = scipy.linalg.eigh(np.diag(omega**2) - slopes.T @ slopes)
        return np.sqrt(np.maximum(values[:count], 0.0)), shapes @ vectors[:, :count]
