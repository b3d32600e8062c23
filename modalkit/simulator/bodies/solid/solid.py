"""A beam or a plate of solid bricks, solved by CalculiX: a reference independent of beam and plate theory.

It offers what ``Beam`` and ``Plate`` do for dry bodies (``body.Body``), and ``cuts``: slots of real width and depth
in its upper face. ``kind`` states whether places are (n, 1) on a beam's centre line or (n, 2) on a plate. A beam is
half of one, held in its plane of symmetry, so that it neither twists nor sways. Modes that move in the plane are left
out. Needs ``ccx`` on the path (``available()``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy.interpolate

from acquisition.arrays import FloatArray, frozen_array
from acquisition.errors import StudyError
from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.bodies.box import Box
from modalkit.simulator.bodies.parts import Attached
from modalkit.simulator.bodies.plate.mesh import plate_lines
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.solid.deck import Bricks, Point, deck, program, run, simpson, trapezoid

_SPARE = 12


@dataclass(frozen=True)
class Cut:
    """A slot in the upper face.

    Parameters
    ----------
    x, extent : float
        Middle and width along the body [m].
    depth : float
        [m].
    across : (low, high), optional
        From where to where it reaches along y; default the whole width [m].
    """

    x: float
    extent: float
    depth: float
    across: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Solid(Box):
    """A box of C3D20R bricks.

    Parameters
    ----------
    kind : {"beam", "plate"}
        How it is read.
    side : float
        The edge y0 [m].
    cuts : tuple of Cut
        Slots; all of the same depth.
    attached : tuple of Attached or PlateAttached
        What is fixed; its inertia is that of a mass on the upper face.
    elements : (along, across, through), optional
        Bricks before refinement; across a beam, of its half [-].
    **more
        As of :class:`Box`; a free body has to hang on springs.
    """

    kind: str
    side: float = 0.0
    cuts: tuple[Cut, ...] = ()
    attached: tuple[Attached | PlateAttached, ...] = ()
    elements: tuple[int, int, int] | None = None

    @property
    def gradients(self) -> tuple[str, ...]:
        """The slopes along the axes."""
        return ("slope",) if self.kind == "beam" else ("slope_x", "slope_y")

    @property
    def rigid_modes(self) -> int:
        """Rigid motions across the surface [-]."""
        return 0 if self.clamped else len(self.gradients) + 1

    @property
    def _share(self) -> float:
        """How much of the body is modelled [-]."""
        return 0.5 if self.kind == "beam" else 1.0

    @cached_property
    def bricks(self) -> Bricks:
        """Its mesh."""
        along, across, through = self.elements or ((36, 1, 2) if self.kind == "beam" else (18, 10, 2))
        windows = tuple((c.x - c.extent / 2, c.x + c.extent / 2) for c in self.cuts)
        x = plate_lines(
            self.start, self.end, elements=along, layer=min(self.thickness, 0.7 * self.length / along), windows=windows,
            lines=tuple(p.x for p in self.attached),
        )  # fmt: skip
        z = np.linspace(0.0, self.thickness, through + 1)
        if self.cuts:
            floor = self.thickness - self.cuts[0].depth
            z = np.unique([*np.linspace(0.0, floor, through), *np.linspace(floor, self.thickness, 2)])
        y = self._across(across)
        cut = np.zeros((len(x) - 1, len(y) - 1, len(z) - 1), bool)
        middle_x, middle_y, middle_z = (0.5 * (a[1:] + a[:-1]) for a in (x, y, z))
        for c in self.cuts:
            low, high = c.across or (-np.inf, np.inf)
            here = np.abs(middle_x - c.x) < c.extent / 2
            there = (middle_y > low) & (middle_y < high)
            cut |= np.multiply.outer(np.multiply.outer(here, there), middle_z > z[-1] - c.depth)
        return Bricks(x, y, z, cut)

    def _across(self, count: int) -> FloatArray:
        low, high = self.side, self.side + self.width
        if self.kind == "beam":
            return np.linspace(0.5 * (low + high), high, count + 1)
        lines = [p.y for p in self.attached if isinstance(p, PlateAttached)]
        lines += [border for c in self.cuts for border in c.across or ()]
        layer = 0.7 * self.width / count
        return plate_lines(low, high, elements=count, layer=layer, lines=tuple(lines))

    def _nearest(self, x: float, y: float) -> int:
        """Return the node on the upper face, or on the floor of a slot, nearest to a place."""
        numbers, places = self.bricks.nodes
        away = np.hypot(places[:, 0] - x, places[:, 1] - y)
        near = np.flatnonzero(away < away.min() + 1e-9)
        return int(numbers[near[np.argmax(places[near, 2])]])

    def _points(self) -> list[Point]:
        points = []
        for part in self.attached:
            y = part.y if isinstance(part, PlateAttached) else self.side + 0.5 * self.width
            node = self._nearest(part.x, y)
            points.append(Point(node, self._share * part.mass, self._share * part.stiffness))
        return points

    def _held(self) -> list[tuple[int, int]]:
        """Return nodes and directions that do not move."""
        numbers, places = self.bricks.nodes
        held: set[tuple[int, int]] = set()
        directions = (2, 3) if np.isfinite(self.clamp_rotation) else (1, 2, 3)
        for face in self.clamped:
            here = np.abs(places[:, 0] - self.bricks.x[0 if face == "x0" else -1]) < 1e-9
            held |= {(int(n), d) for n in numbers[here] for d in directions}
        if self.kind == "beam":
            held |= {(int(n), 2) for n in numbers[np.abs(places[:, 1] - self.bricks.y[0]) < 1e-9]}
        if not self.clamped:
            centre = np.array([*np.mean(places[:, :2], axis=0), 0.5 * self.thickness])
            core = int(np.argmin(np.abs(places - centre).sum(axis=1)))
            held.add((int(numbers[core]), 1))
            level = np.flatnonzero(np.abs(places[:, 1:] - places[core, 1:]).sum(axis=1) < 1e-9)
            held |= {(int(numbers[n]), 2) for n in (core, level[-1])}
        return sorted(held)

    def _clamp_springs(self) -> list[Point]:
        """Return springs along x all over the clamped faces, in the rigid faces' place."""
        if not np.isfinite(self.clamp_rotation):
            return []
        bricks = self.bricks
        line = self.clamp_rotation / (self.width if self.kind == "beam" else 1.0) / (self.thickness**3 / 12)
        through = simpson(bricks.z)
        springs = []
        for face in self.clamped:
            i = 0 if face == "x0" else 2 * len(bricks.x) - 2
            for k, depth in enumerate(through):
                whole = k % 2 == 0
                shares = simpson(bricks.y) if whole else trapezoid(bricks.y)
                for j, share in enumerate(shares):
                    node = bricks.number(np.array(i), np.array(j if whole else 2 * j), np.array(k))
                    springs.append(Point(int(node), spring=line * depth * share, direction=1))
        return springs

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes that move across the surface.

        Parameters
        ----------
        count : int
            How many [-].

        Returns
        -------
        omega : (count,) array
            Angular frequencies [rad/s].
        shapes : (n_dofs, count) array
            Mass-normalised deflections at the crossings of the mesh's lines [kg^-1/2].

        Raises
        ------
        StudyError
            If CalculiX is missing or fails.
        """
        return _solved(self, count)

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows that read the deflection ``w`` or its slopes, by splines through the crossings.

        Parameters
        ----------
        places : (n, dim) array
            Positions [m].
        quantity : {"w", "slope", "slope_x", "slope_y"}
            What to read.
        """
        places = np.asarray(places, float).reshape(-1, len(self.gradients))
        along = _spline(self.bricks.x, places[:, 0], quantity in ("slope", "slope_x"))
        if self.kind == "beam":
            return np.kron(along, np.eye(len(self.bricks.y))[0])
        across = _spline(self.bricks.y, places[:, 1], quantity == "slope_y")
        return np.asarray(np.einsum("ni,nj->nij", along, across).reshape(len(places), -1))

    def _modal(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return mass and stiffness of the material in the modes, and the dashpots."""
        omega, _ = self.real_modes(shapes.shape[1])
        mass, stiffness, dashpots = np.eye(len(omega)), np.diag(omega**2), np.zeros((len(omega),) * 2)
        for part in self.attached:
            place = [part.x, part.y] if isinstance(part, PlateAttached) else [part.x]
            here = (self.rows(np.array([place]), "w") @ shapes)[0]
            product = np.outer(here, here)
            mass, stiffness = mass - part.mass * product, stiffness - part.stiffness * product
            dashpots = dashpots + part.damping * product
        return mass, stiffness, dashpots

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the damping that the modeller expects, and what else is viscous, of what ``real_modes`` gave."""
        mass, stiffness, dashpots = self._modal(shapes)
        others = self.added_alpha * np.eye(len(mass)) + self.added_beta * stiffness + dashpots
        return self.alpha * mass + self.beta * stiffness, others

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return structural damping of the whole."""
        return (Loss(self.added_loss * self._modal(shapes)[1], -1.0),) if self.added_loss else ()


def available() -> bool:
    """Return whether CalculiX is on the path."""
    return program() is not None


@lru_cache(maxsize=32)
def _solved(solid: Solid, count: int) -> tuple[FloatArray, FloatArray]:
    if not solid.clamped and not any(p.stiffness for p in solid.attached):
        raise StudyError("a free solid hangs on nothing: attach springs to it")
    held, points = solid._held(), solid._points() + solid._clamp_springs()
    text = deck(
        solid.bricks, E=solid.E, density=solid.density, poisson=solid.poisson, held=held,
        points=points, count=count + _SPARE,
    )  # fmt: skip
    omega, moved = run(text, read=solid.bricks.bottom().ravel())
    level = np.sqrt(np.mean(moved**2, axis=1))
    across = np.flatnonzero(level[:, 2] > np.hypot(level[:, 0], level[:, 1]))[:count]
    if len(across) < count:
        raise StudyError(
            f"ccx found {len(across)} modes across a solid's surface, not {count}: ask for fewer"
        )
    shapes = np.sqrt(solid._share) * moved[across, :, 2].T
    return frozen_array(omega[across]), frozen_array(shapes)


def _spline(lines: FloatArray, places: FloatArray, slope: bool) -> FloatArray:
    """Return weights of the values at lines in a cubic spline's value or slope at places."""
    spline = scipy.interpolate.make_interp_spline(lines, np.eye(len(lines)), k=min(3, len(lines) - 1))
    return np.asarray(spline(places, nu=int(slope)))
