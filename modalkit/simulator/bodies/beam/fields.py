"""What a beam of the rig is made of: its dimensions, material and parts, and their values along it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.box import Surrounded
from modalkit.simulator.bodies.element import GAUSS, element_nodes, gauss_places, gauss_rows, readers
from modalkit.simulator.bodies.mesh import graded_mesh
from modalkit.simulator.bodies.parts import Absorber, Attached, Notch, Stretch

STIFF = 1e5
"""By how much shear stiffness grows and rotary inertia falls where they are left out [-]."""


@dataclass(frozen=True, kw_only=True)
class BeamFields(Surrounded):
    """A beam of rectangular section, as far as it can be described without solving anything.

    Parameters
    ----------
    notches, stretches, attached, absorbers : tuples
        Local losses of stiffness; changed sections; masses, springs and dashpots; masses that hang.
    elements : int
        Elements before refinement [-].
    **more
        As of :class:`Surrounded`.
    """

    notches: tuple[Notch, ...] = ()
    stretches: tuple[Stretch, ...] = ()
    attached: tuple[Attached, ...] = ()
    absorbers: tuple[Absorber, ...] = ()
    elements: int = 14

    @property
    def gradients(self) -> tuple[str, ...]:
        """The slope, along the one axis."""
        return ("slope",)

    @property
    def rigid_modes(self) -> int:
        """Two of a free beam, none of a clamped one [-]."""
        return 0 if self.clamped else 2

    @property
    def bending_stiffness(self) -> float:
        """E I of the undisturbed section [N m2]."""
        return self.E * self.width * self.thickness**3 / 12

    @cached_property
    def edges(self) -> FloatArray:
        """Borders of the elements, shape (n_elements + 1,) [m]."""
        windows = [(n.x - n.extent / 2, n.x + n.extent / 2) for n in self.notches]
        windows += [s.window for s in self.stretches]
        return graded_mesh(self.start, self.end, elements=self.elements, windows=tuple(windows))

    @cached_property
    def nodes(self) -> FloatArray:
        """Positions of the nodes, shape (n_nodes,) [m]."""
        return element_nodes(self.edges)

    @property
    def n_dofs(self) -> int:
        """Degrees of freedom: two a node, and one for every mass that hangs [-]."""
        return 2 * len(self.nodes) + len(self.absorbers)

    @property
    def shear_modulus(self) -> float:
        """Kappa times G [Pa]."""
        kappa = 10 * (1 + self.poisson) / (12 + 11 * self.poisson)
        return kappa * self.E / (2 * (1 + self.poisson)) * (1.0 if self.shear else STIFF)

    def thickness_at(self, x: FloatArray) -> FloatArray:
        """Return the thickness at places, shape as ``x`` [m]."""
        return self.thickness * (1.0 + self.taper * self.middled(x))

    @cached_property
    def gauss(self) -> tuple[FloatArray, dict[str, FloatArray]]:
        """Gauss points, (n_elements, 8) [m], and what reads an element's DOFs there."""
        return gauss_places(self.edges), readers(GAUSS, np.diff(self.edges)[:, None])

    def spread(self, quantity: FloatArray, weight: FloatArray) -> FloatArray:
        """Return rows over all DOFs whose product with themselves integrates ``weight quantity^2``."""
        rows = gauss_rows(self.edges, quantity) * np.sqrt(weight).reshape(-1, 1)
        return np.pad(rows, ((0, 0), (0, len(self.absorbers))))

    @cached_property
    def bending(self) -> FloatArray:
        """E I at the Gauss points [N m2]."""
        x, _ = self.gauss
        bending = self.E * self.width * self.thickness_at(x) ** 3 / 12
        for notch in self.notches:
            bending = bending * notch.factor(x)
        for part in self.stretches:
            bending = bending * (1.0 + (part.bending - 1.0) * part.inside(x))
        return bending
