"""What may be fixed to a plate, laid on it or cut into it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray


@dataclass(frozen=True)
class PlateAttached:
    """Something fixed to the plate at one place.

    Parameters
    ----------
    x, y : float
        Position [m].
    mass, inertia : float
        Mass [kg] and rotary inertia about any axis in the plate's plane [kg m2].
    stiffness, damping : float
        Spring [N/m] and dashpot [N s/m] to the ground.
    """

    x: float
    y: float
    mass: float = 0.0
    inertia: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class PlateAbsorber:
    """A mass that hangs on the plate by a spring and a dashpot, free to move by itself.

    Parameters
    ----------
    x, y : float
        Position [m].
    mass : float
        [kg].
    stiffness, damping : float
        Between the mass and the plate [N/m], [N s/m].
    """

    x: float
    y: float
    mass: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Spot:
    """A rectangle with its sides along the plate's.

    Parameters
    ----------
    x, y : float
        Centre [m].
    extent, across : float
        Whole size along x and along y [m].
    """

    x: float
    y: float
    extent: float
    across: float

    def windows(self, side: str) -> tuple[float, float]:
        """Return its borders along the side ``x`` or ``y`` [m]."""
        centre, size = (self.x, self.extent) if side == "x" else (self.y, self.across)
        return centre - size / 2, centre + size / 2

    def local(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return places relative to the rectangle, -1/2 to 1/2 inside [-]."""
        return (x - self.x) / self.extent, (y - self.y) / self.across

    def covers(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return 1 inside and 0 outside [-]."""
        u, v = self.local(x, y)
        inside: FloatArray = ((np.abs(u) < 0.5) & (np.abs(v) < 0.5)).astype(float)
        return inside


@dataclass(frozen=True)
class SoftSpot(Spot):
    """A local loss of bending stiffness: a smooth dip, or a rectangle with sharp sides.

    Parameters
    ----------
    loss : float
        Loss of D at the centre, or all over [-].
    smooth : bool
        Whether the loss falls off as cos^2(pi u) cos^2(pi v).
    """

    loss: float = 0.0
    smooth: bool = True

    def factor(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the factor on the bending stiffness [-]."""
        u, v = self.local(x, y)
        dip = np.cos(np.pi * u) ** 2 * np.cos(np.pi * v) ** 2 if self.smooth else 1.0
        return 1.0 - self.loss * dip * self.covers(x, y)


@dataclass(frozen=True)
class Patch(Spot):
    """A layer with sharp sides that damps what it covers.

    Parameters
    ----------
    loss_factor : float
        Of the covered part, K (1 + i eta) [-].
    alpha, beta : float
        Its viscous damping, C = alpha M + beta K [1/s], [s].
    mass, stiffness : float
        What the layer adds, relative to the bare plate's mass and bending stiffness there [-].
    """

    loss_factor: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0
    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True)
class Cavity:
    """A closed volume behind the plate, with a mass of air in its neck: a resonator driven by the volume displaced.

    The pressure is ``stiffness`` times the volume that the plate takes less the volume that leaves by the neck
    (Kinsler, Fundamentals of Acoustics, 4th ed., section 10.8).

    Parameters
    ----------
    stiffness : float
        Of the air shut in, rho c^2 / V [Pa/m3].
    inertance, resistance : float
        Of the neck: pressure over the acceleration and over the rate of its volume [kg/m4], [Pa s/m3].
    """

    stiffness: float
    inertance: float
    resistance: float = 0.0


@dataclass(frozen=True)
class Rib:
    """A straight rib along the plate's surface.

    Parameters
    ----------
    start, end : (x, y)
        Where it begins and ends [m].
    bending, torsion : float
        What it adds to bending along itself, E I [N m2], and to twist, G J [N m2].
    line_mass : float
        Its mass [kg/m].
    """

    start: tuple[float, float]
    end: tuple[float, float]
    bending: float
    torsion: float = 0.0
    line_mass: float = 0.0

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(np.hypot(*self._run))

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector along it [-]."""
        run = self._run
        return run[0] / self.length, run[1] / self.length

    @property
    def _run(self) -> tuple[float, float]:
        return self.end[0] - self.start[0], self.end[1] - self.start[1]


def flat_rib(
    start: tuple[float, float],
    end: tuple[float, float],
    *,
    width: float,
    height: float,
    thickness: float,
    E: float,
    density: float,
    poisson: float = 0.3,
) -> Rib:
    """Return a rectangular bar welded on its edge to a plate of the same material.

    Parameters
    ----------
    start, end : (x, y)
        Where it begins and ends [m].
    width, height : float
        Of the bar; the height stands on the plate [m].
    thickness : float
        Of the plate [m].
    E, density, poisson : float
        Of the material [Pa], [kg/m3], [-].

    Returns
    -------
    Rib
        Bending about the common neutral plane with as much of the plate beside the bar as six times the
        plate's thickness on either side (a rule for flanges; Timoshenko and Gere, Theory of Elastic
        Stability, 2nd ed., section 9.11); torsion of a bar, h b^3 / 3 (1 - 0.63 b / h).
    """
    bar, flange = width * height, (12 * thickness + width) * thickness
    arm = 0.5 * (height + thickness)
    inertia = width * height**3 / 12 + bar * flange / (bar + flange) * arm**2
    low, high = min(width, height), max(width, height)
    twist = E / (2 * (1 + poisson)) * high * low**3 / 3 * (1 - 0.63 * low / high)
    return Rib(start, end, bending=E * inertia, torsion=twist, line_mass=density * bar)
