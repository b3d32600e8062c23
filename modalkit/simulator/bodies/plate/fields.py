"""What a plate of the rig is made of: its dimensions, material and parts, and their values over its grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.box import Surrounded
from modalkit.simulator.bodies.plate.grid import Grid
from modalkit.simulator.bodies.plate.matrices import Section
from modalkit.simulator.bodies.plate.mesh import plate_lines
from modalkit.simulator.bodies.plate.parts import (
    Cavity,
    Patch,
    PlateAbsorber,
    PlateAttached,
    Rib,
    SoftSpot,
    Spot,
)

_STIFF = 100.0
_LAYER = 1.5
_ELEMENTS = 30


@dataclass(frozen=True, kw_only=True)
class PlateFields(Surrounded):
    """A rectangular plate, as far as it can be described without solving anything.

    Parameters
    ----------
    side : float
        The edge y0 [m].
    clamp_from, clamp_to : float
        From where to where along each held edge it gives way, in the model's axes; the rest of the edge holds [m].
    skew : float
        Angle between the edge x0 and the y axis about its middle, positive towards +x at y1 [rad].
    ratio : float
        E across over E along; coupling, twist and shear follow the geometric mean [-].
    shear_ratio : float
        Shear modulus in the plane, which twist follows, over that of the geometric mean [-].
    axial_across : float
        Tension along y [N].
    axial_bow : float
        Relative excess of the tension along x in the middle of the width over the mean, which the edges lack twice [-].
    wall : bool
        Whether the only held edge x0 stands at an endless wall, through which no fluid flows.
    shear_factor : float
        Kappa (Reissner) [-].
    spots, patches, ribs, attached, absorbers : tuples
        Local losses of stiffness; layers; ribs; masses, springs and dashpots; masses that hang.
    cavity : Cavity, optional
        Air shut in behind it.
    elements : (along, across), optional
        Elements before refinement, without the narrow ones along the edges; default some thirty, nearly square
        [-].
    **more
        As of :class:`Surrounded`.
    """

    side: float = 0.0
    clamp_from: float = -np.inf
    clamp_to: float = np.inf
    skew: float = 0.0
    ratio: float = 1.0
    shear_ratio: float = 1.0
    axial_across: float = 0.0
    axial_bow: float = 0.0
    wall: bool = True
    shear_factor: float = 5.0 / 6.0
    spots: tuple[SoftSpot, ...] = ()
    patches: tuple[Patch, ...] = ()
    ribs: tuple[Rib, ...] = ()
    attached: tuple[PlateAttached, ...] = ()
    absorbers: tuple[PlateAbsorber, ...] = ()
    cavity: Cavity | None = None
    elements: tuple[int, int] | None = None

    @property
    def bending_stiffness(self) -> float:
        """D of the undisturbed plate, per width, along x [N m]."""
        return self.E * self.thickness**3 / (12 * (1 - self.poisson**2))

    @property
    def gives_way(self) -> tuple[float, float]:
        """From where to where along the held edges they give way [m]."""
        return self.clamp_from, self.clamp_to

    @property
    def gradients(self) -> tuple[str, ...]:
        """The slopes along both axes."""
        return ("slope_x", "slope_y")

    @property
    def rigid_modes(self) -> int:
        """Three of a free plate, none of a held one [-]."""
        return 0 if self.clamped else 3

    @cached_property
    def grid(self) -> Grid:
        """Its elements; a narrow row along the edges holds the layer in which twisting moments die away."""
        along = self._lines(0, self.start, self.end)
        across = self._lines(1, self.side, self.side + self.width)
        return Grid(along, across, float(np.tan(self.skew)))

    @property
    def mesh(self) -> tuple[int, int]:
        """Elements along and across, before refinement [-]."""
        if self.elements is not None:
            return self.elements
        size = np.sqrt(self.length * self.width / _ELEMENTS)
        along, across = (max(2, int(np.ceil(side / size - 0.3))) for side in (self.length, self.width))
        return along, across

    def _lines(self, axis: int, low: float, high: float) -> FloatArray:
        spots: tuple[Spot, ...] = (*self.spots, *self.patches)
        return plate_lines(
            low,
            high,
            elements=self.mesh[axis],
            layer=_LAYER * self.thickness,
            windows=tuple(s.windows("xy"[axis]) for s in spots),
            lines=(
                *(r.start[axis] for r in self.ribs if abs(r.direction[axis]) < 1e-9),
                *(at for at in self.gives_way if any(edge[0] != "xy"[axis] for edge in self.clamped)),
            ),
        )

    @cached_property
    def points(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gauss points on the plate, x and y, and the thickness there [m]."""
        grid_x, y, _, _ = self.grid.gauss
        thick = self.thickness * (1.0 + self.taper * self.middled(grid_x))
        return self.grid.place(grid_x, y), y, thick

    @property
    def load(self) -> FloatArray:
        """Tension along x per width at the Gauss points [N/m]."""
        x, y, _ = self.points
        across = 2 * (y - self.side) / self.width - 1.0
        spread = 1.0 + 2 * self.axial_lean * self.middled(x) + self.axial_bow * (1.0 - 3.0 * across**2)
        return self.axial / self.width * spread

    @cached_property
    def section(self) -> Section:
        """Stiffness of the bare plate at the Gauss points."""
        x, y, thick = self.points
        bending = self.E * thick**3 / (12 * (1 - self.poisson**2))
        for spot in self.spots:
            bending = bending * spot.factor(x, y)
        modulus = self.shear_factor * self.E / (2 * (1 + self.poisson)) * np.sqrt(self.ratio)
        shear = modulus * thick * (1.0 if self.shear else _STIFF)
        return Section(bending, shear, self.ratio, self.poisson, self.shear_ratio)

    def under(self, patch: Patch) -> Section:
        """Return the stiffness of the bare plate where a patch covers it, and nothing elsewhere."""
        x, y, _ = self.points
        bare = self.section
        return Section(
            bare.bending * patch.covers(x, y), bare.shear, bare.ratio, bare.poisson, bare.shear_ratio
        )

    def mass_under(self, patch: Patch) -> tuple[FloatArray, FloatArray]:
        """Return mass and rotary inertia per area where a patch covers the plate, and nothing elsewhere."""
        x, y, _ = self.points
        area, rotary = self.inertia()
        covered = patch.covers(x, y)
        return area * covered, rotary * covered

    def inertia(self) -> tuple[FloatArray, FloatArray]:
        """Return mass and rotary inertia per area at the Gauss points [kg/m2], [kg]."""
        x, y, thick = self.points
        area = self.density * thick * (1.0 + self.density_slope * self.middled(x))
        rotary = area * thick**2 / 12 / (1.0 if self.shear else _STIFF**2)
        for patch in self.patches:
            area = area * (1.0 + patch.mass * patch.covers(x, y))
        return area, rotary
