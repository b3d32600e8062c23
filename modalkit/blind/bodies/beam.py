"""The rig's specimen: a fine non-uniform Timoshenko beam, clamped at its start or free.

It shares no code with the models of the candidates. Shear coefficient: Cowper, J. Appl. Mech. 33 (1966) 335,
rectangular section, 10 (1 + nu) / (12 + 11 nu).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg

from acquisition.arrays import FloatArray
from modalkit.blind.bodies.element import (
    GAUSS,
    NODES,
    ORDER,
    element_nodes,
    gauss_places,
    gauss_rows,
    readers,
)
from modalkit.blind.bodies.mesh import graded_mesh
from modalkit.blind.bodies.parts import Attached, Notch
from modalkit.blind.bodies.water import added_mass

_STIFF = 1e5


@dataclass(frozen=True)
class Beam:
    """A beam from ``start`` to ``end`` of rectangular section, moving in the direction of its thickness.

    Parameters
    ----------
    start, end : float
        Positions of its ends in the model's axes [m]; it is clamped at ``start``.
    width, thickness : float
        Section [m].
    E, density : float
        Young's modulus [Pa] and density [kg/m3].
    poisson : float
        Poisson's ratio [-].
    clamped : bool
        Whether the start is held; otherwise the beam is free.
    clamp_rotation : float
        Rotational stiffness of the clamp [N m/rad].
    taper : float
        Relative change of thickness from start to end, about the middle [-].
    fluid_density : float
        Density of the fluid all around [kg/m3].
    shear : bool
        False leaves out shear and rotary inertia: only for telling what they do.
    notches, attached : tuples
        Local losses of stiffness; masses and springs.
    alpha, beta : float
        Rayleigh damping of the material [1/s], [s].
    elements : int
        Elements before refinement [-].
    """

    start: float
    end: float
    width: float
    thickness: float
    E: float
    density: float
    poisson: float = 0.3
    clamped: bool = True
    clamp_rotation: float = np.inf
    taper: float = 0.0
    fluid_density: float = 0.0
    shear: bool = True
    notches: tuple[Notch, ...] = ()
    attached: tuple[Attached, ...] = ()
    alpha: float = 0.0
    beta: float = 0.0
    elements: int = 14

    @property
    def length(self) -> float:
        """Free length [m]."""
        return self.end - self.start

    @property
    def mass(self) -> float:
        """Mass of the beam alone [kg]."""
        return self.density * self.width * self.thickness * self.length

    @property
    def bending_stiffness(self) -> float:
        """E I of the undisturbed section [N m2]."""
        return self.E * self.width * self.thickness**3 / 12

    @cached_property
    def edges(self) -> FloatArray:
        """Borders of the elements, shape (n_elements + 1,) [m]."""
        windows = tuple((n.x - n.extent / 2, n.x + n.extent / 2) for n in self.notches)
        return graded_mesh(self.start, self.end, elements=self.elements, windows=windows)

    @cached_property
    def nodes(self) -> FloatArray:
        """Positions of the nodes, shape (n_nodes,) [m]."""
        return element_nodes(self.edges)

    @property
    def _shear_modulus(self) -> float:
        """Kappa times G [Pa]."""
        kappa = 10 * (1 + self.poisson) / (12 + 11 * self.poisson)
        return kappa * self.E / (2 * (1 + self.poisson)) * (1.0 if self.shear else _STIFF)

    def _thickness_at(self, x: FloatArray) -> FloatArray:
        return self.thickness * (1.0 + self.taper * ((x - self.start) / self.length - 0.5))

    @cached_property
    def _strain_rows(self) -> FloatArray:
        """F with F^T F the stiffness of the material [sqrt(N/m)]."""
        x, read = self._gauss
        t = self._thickness_at(x)
        bending = self.E * self.width * t**3 / 12
        for notch in self.notches:
            bending = bending * notch.factor(x)
        shear = self._shear_modulus * self.width * t
        bend, slide = read["curvature"], read["slope"] - read["theta"]
        return np.vstack(
            [
                gauss_rows(self.edges, bend) * np.sqrt(bending).reshape(-1, 1),
                gauss_rows(self.edges, slide) * np.sqrt(shear).reshape(-1, 1),
            ]
        )

    @cached_property
    def _gauss(self) -> tuple[FloatArray, dict[str, FloatArray]]:
        return gauss_places(self.edges), readers(GAUSS, np.diff(self.edges)[:, None])

    @cached_property
    def _material_mass(self) -> FloatArray:
        x, read = self._gauss
        t = self._thickness_at(x)
        line = self.density * self.width * t
        rotary = line * t**2 / 12 / (1.0 if self.shear else _STIFF)
        move = gauss_rows(self.edges, read["w"]) * np.sqrt(line).reshape(-1, 1)
        turn = gauss_rows(self.edges, read["theta"]) * np.sqrt(rotary).reshape(-1, 1)
        mass: FloatArray = move.T @ move + turn.T @ turn
        return mass

    def _whole_mass(self) -> FloatArray:
        mass = self._material_mass
        for part in self.attached:
            here, turn = self._row(part.x, "w"), self._row(part.x, "theta")
            mass = mass + part.mass * np.outer(here, here) + part.inertia * np.outer(turn, turn)
        return mass + self._fluid_mass() if self.fluid_density else mass

    def _spring_rows(self) -> FloatArray:
        rows = [np.sqrt(p.stiffness) * self._row(p.x, "w") for p in self.attached if p.stiffness]
        if self.clamped and np.isfinite(self.clamp_rotation):
            rows.append(np.sqrt(self.clamp_rotation) * self._row(self.start, "theta"))
        return np.array(rows).reshape(len(rows), 2 * len(self.nodes))

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what damps some modes: the material, and the dashpots.

        Parameters
        ----------
        shapes : (n_dofs, n_modes) array
            Mass-normalised real modes [kg^-1/2].

        Returns
        -------
        material, dashpots : (n_modes, n_modes) arrays
            Symmetric damping matrices in the modes [1/s].
        """
        strain = self._strain_rows @ shapes
        material = self.alpha * shapes.T @ self._material_mass @ shapes + self.beta * strain.T @ strain
        dashpots = np.zeros_like(material)
        for part in self.attached:
            here = self._row(part.x, "w") @ shapes
            dashpots = dashpots + part.damping * np.outer(here, here)
        return material, dashpots

    def _fluid_mass(self) -> FloatArray:
        stations, matrix = added_mass(self.length, self.width, self.thickness, density=self.fluid_density)
        rows = self.rows(self.start + stations, "w")
        return rows.T @ matrix @ rows

    def rows(self, x: FloatArray, quantity: str) -> FloatArray:
        """Return rows that read the deflection ``w``, its ``slope`` or the rotation ``theta`` at places.

        Parameters
        ----------
        x : (n,) array
            Positions [m].
        quantity : {"w", "slope", "theta", "curvature"}
            What to read.

        Returns
        -------
        (n, 2 n_nodes) array
            Rows to multiply with a vector of DOFs.
        """
        x = np.asarray(x, float)
        element = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        size = np.diff(self.edges)[element]
        local = readers((x - self.edges[element]) / size, size)[quantity]
        out = np.zeros((len(x), 2 * len(self.nodes)))
        np.put_along_axis(out, 2 * ORDER * element[:, None] + np.arange(2 * NODES), local, axis=1)
        return out

    def _row(self, x: float, quantity: str) -> FloatArray:
        row: FloatArray = self.rows(np.array([x]), quantity)[0]
        return row

    @cached_property
    def _kept(self) -> slice:
        if not self.clamped:
            return slice(0, None)
        return slice(1 if np.isfinite(self.clamp_rotation) else 2, None)

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes.

        Parameters
        ----------
        count : int
            How many [-].

        Returns
        -------
        omega : (count,) array
            Angular frequencies; zero for rigid-body motion [rad/s].
        shapes : (2 n_nodes, count) array
            Mass-normalised shapes in all DOFs [kg^-1/2].

        Notes
        -----
        With stiffness F^T F and mass L L^T the frequencies are the singular values of F L^-T, whose rounding
        is that of the highest frequency; the eigenvalues of the products would lose the lowest modes of
        slender beams (Golub and Van Loan, Matrix Computations, 4th ed., section 8.7).
        """
        keep = self._kept
        factor = scipy.linalg.cholesky(self._whole_mass()[keep, keep], lower=True)
        rows = np.vstack([self._strain_rows, self._spring_rows()])[:, keep]
        scaled = scipy.linalg.solve_triangular(factor, rows.T, lower=True).T
        _, omega, vectors = scipy.linalg.svd(scaled, full_matrices=False)
        shapes = np.zeros((2 * len(self.nodes), count))
        shapes[keep] = scipy.linalg.solve_triangular(factor, vectors[::-1][:count].T, lower=True, trans="T")
        return omega[::-1][:count], shapes
