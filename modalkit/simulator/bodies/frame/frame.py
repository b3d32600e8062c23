"""A ladder of two rails and some rungs, bolted to each other, that stands out from two feet and is hit across.

It offers what ``Beam`` and ``Plate`` do (``body.Body``) in two axes. What a study models by coarser matrices
(:mod:`modalkit.simulator.frame_model`) is this body with fewer elements and nothing hidden.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.bodies.frame.grillage import Bar, Grillage, rows_of
from modalkit.simulator.bodies.parted import Parted

SHIFT, TURN = 3e3, 60.0
"""A joint as drawn, over E I / L^3 and E I / L of a rung: firm, and not rigid [-]."""

STEEL = 7850.0


@dataclass(frozen=True, kw_only=True)
class Frame(Parted):
    """The ladder.

    Parameters
    ----------
    start, end, width : float
        Where the rails begin and end along x, and how far apart they are along y [m].
    breadth, thickness : float
        Section of all bars, the second across the plane [m].
    E, density, poisson : float
        Material [Pa], [kg/m3], [-].
    rungs : tuple of float
        Where they are, over the length of the rails [-].
    elements : int
        Of each stretch of bar between joints [-].
    **more
        As of :class:`Parted`: joints turn, feet turn about y [N m/rad], and a mass that is fixed turns as a steel cube
        does.
    """

    start: float
    end: float
    width: float
    breadth: float
    thickness: float
    E: float
    density: float
    poisson: float
    rungs: tuple[float, ...]
    elements: int = 12

    @property
    def mass(self) -> float:
        """Mass of the bars as drawn [kg]."""
        length = 2 * (self.end - self.start) + len(self.rungs) * self.width
        return self.density * self.breadth * self.thickness * length

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its parts: each rail between two rungs, and each rung."""
        return tuple(dict.fromkeys(bar.part for bar in self.mesh.bars))

    @cached_property
    def mesh(self) -> Grillage:
        """Nodes and bars."""
        places: list[tuple[float, float]] = []
        bars: list[Bar] = []
        joints: dict[str, tuple[int, int]] = {}

        def node(x: float, y: float) -> int:
            places.append((x, y))
            return len(places) - 1

        def lay(part: str, first: int, last: int) -> None:
            a, b = np.array(places[first]), np.array(places[last])
            inner = [node(*(a + (b - a) * i / self.elements)) for i in range(1, self.elements)]
            nodes = [first, *inner, last]
            bars.extend(Bar(part, pair) for pair in pairwise(nodes))

        length = self.end - self.start
        knots = {
            side: [node(self.start + share * length, y) for share in (0.0, *self.rungs)]
            for side, y in (("left", 0.0), ("right", self.width))
        }
        for side, own in knots.items():
            for i, pair in enumerate(pairwise(own), start=1):
                lay(f"rail_{side}_{i}", *pair)
        for i, share in enumerate(self.rungs, start=1):
            ends = [node(self.start + share * length, y) for y in (0.0, self.width)]
            lay(f"rung_{i}", ends[0], ends[1])
            joints |= {
                f"bolt_{side}_{i}": (knots[side][i], end) for side, end in zip(knots, ends, strict=True)
            }
        return Grillage(np.array(places), tuple(bars), joints)

    @property
    def held(self) -> dict[str, int]:
        """Node of each foot."""
        at = self.mesh.places
        return {
            f"foot_{side}": int(np.argmin(np.abs(at - [self.start, y]).sum(axis=1)))
            for side, y in (("left", 0.0), ("right", self.width))
        }

    @property
    def joint_stiffness(self) -> tuple[float, float]:
        """Stiffness of a joint as drawn, against shifting [N/m] and turning [N m/rad]."""
        rigidity = self.E * self.breadth * self.thickness**3 / 12
        return SHIFT * rigidity / self.width**3, TURN * rigidity / self.width

    def place_of(self, name: str) -> tuple[float, float]:
        """Return the middle of a part, a joint or a foot along x and y [m]."""
        mesh = self.mesh
        nodes: Sequence[int] = [n for bar in mesh.bars if bar.part == name for n in bar.nodes]
        nodes = nodes or mesh.joints.get(name) or [self.held[name]]
        low, high = mesh.places[list(nodes)].min(axis=0), mesh.places[list(nodes)].max(axis=0)
        x, y = ((low + high) / 2).tolist()
        return float(x), float(y)

    def parts(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Return stiffness and mass of every part as it is, (order, order) [SI]."""
        plain = self.mesh.parts((self.breadth, self.thickness), (self.E, self.density, self.poisson))
        stiff, heavy = dict(self.stiff), dict(self.heavy)
        return {name: (stiff.get(name, 1.0) * k, heavy.get(name, 1.0) * m) for name, (k, m) in plain.items()}

    def joints(self) -> FloatArray:
        """Return the stiffness of all joints as they are, (order, order) [SI]."""
        shift, turn = self.joint_stiffness
        left = dict(self.loose)
        mesh = self.mesh
        every = [mesh.springs(name, shift, turn * left.get(name, 1.0)) for name in mesh.joints]
        return np.asarray(np.sum(every, axis=0))

    @cached_property
    def matrices(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Stiffness, mass, dashpots, and what of the stiffness is no material, over all rows, (order, order) [SI]."""
        parts = self.parts()
        material = np.sum([k for k, _ in parts.values()], axis=0) + self.joints()
        mass = np.sum([m for _, m in parts.values()], axis=0)
        others, dashpots = np.zeros_like(mass), np.zeros_like(mass)
        for foot, spring in self.feet:
            row = 3 * self.held[foot] + 1
            others[row, row] += spring
        for part in self.attached:
            reads = [self.mesh.reads(np.array([[part.x, part.y]]), q)[0] for q in ("w", "slope_x", "slope_y")]
            across = np.outer(reads[0], reads[0])
            inertia = part.inertia * sum(np.outer(row, row) for row in reads[1:])
            mass = mass + part.mass * across + inertia
            others, dashpots = others + part.stiffness * across, dashpots + part.damping * across
        return material + others, mass, dashpots, others

    @property
    def free(self) -> list[int]:
        """Rows that nothing holds."""
        turned = {3 * self.held[foot] + 1 for foot, _ in self.feet}
        still = {int(row) for node in self.held.values() for row in rows_of([node])} - turned
        return [row for row in range(self.mesh.order) if row not in still]

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes: omega (count,) [rad/s], shapes (order, count) [kg^-1/2]."""
        stiffness, mass, *_ = self.matrices
        free = np.ix_(self.free, self.free)
        values, vectors = eigh(stiffness[free], mass[free], subset_by_index=(0, count - 1))
        shapes = np.zeros((self.mesh.order, count))
        shapes[self.free] = vectors
        return np.sqrt(values), shapes

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows, (n, order), that read ``w``, ``slope_x`` or ``slope_y`` at places (n, 2) [m]."""
        return self.mesh.reads(np.asarray(places, dtype=float).reshape(-1, 2), quantity)

    def _material(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return mass and stiffness of the bars and joints in the modes, (n, n)."""
        stiffness, _, _, others = self.matrices
        mass = np.sum([m for _, m in self.parts().values()], axis=0)
        return shapes.T @ mass @ shapes, shapes.T @ (stiffness - others) @ shapes

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the damping that the modeller expects, and what else is viscous, of what ``real_modes`` gave."""
        mass, stiffness = self._material(shapes)
        dashpots = shapes.T @ self.matrices[2] @ shapes
        others = self.added_alpha * mass + self.added_beta * stiffness + dashpots
        return self.alpha * mass + self.beta * stiffness, others

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return structural damping of the whole."""
        return (Loss(self.added_loss * self._material(shapes)[1], -1.0),) if self.added_loss else ()
