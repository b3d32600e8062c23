"""What the modeller and the test engineer believe and state: the contents of the study file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.body import Body
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.bodies.plate.plate import Plate
from modalkit.simulator.bodies.solid.solid import Solid

BY_MATRICES = ("frame", "ribbed", "bracket")
"""Kinds of specimen that the study models by matrices."""

UNCALIBRATED = 0.3
"""From this uncertainty of the level on, a test has no absolute level [-]."""


@dataclass(frozen=True)
class Tolerances:
    """The modeller's own doubts, relative 1-sigma [-]."""

    E: float = 0.01
    density: float = 0.003
    thickness: float = 0.005
    length: float = 0.002
    width: float = 0.002
    damping: float = 0.3


@dataclass(frozen=True)
class Setup:
    """A specimen as drawn by its maker, and the plan of its test. Nothing in it depends on the hidden effect.

    Parameters
    ----------
    kind : {"beam", "plate", "solid", "frame", "ribbed", "bracket"}
        Of the specimen; a solid is modelled as a beam, and made of bricks; the last three as matrices.
    title : str
        Neutral title.
    length, width, thickness : float
        Nominal dimensions [m].
    E, density, poisson : float
        Nominal material [Pa], [kg/m3], [-].
    clamped : tuple of str
        Clamped edges of x0, x1, y0, y1; none is free on soft springs.
    theory : {"timoshenko", "euler-bernoulli", "kirchhoff"}
        Of the model.
    elements : tuple of int
        Of the model, along each axis [-].
    tolerances : Tolerances
        Stated, and true: the specimen is drawn from them.
    alpha, beta : float
        Rayleigh damping the modeller expects [1/s], [s].
    points : tuple of (x,) or (x, y)
        Where the hammer hits, in the model's axes [m].
    sensor : int
        Index of the point under the accelerometer [-].
    drive : bool
        Whether the sensor's own point is hit too.
    sensor_sign : int
        -1 where the sensor looks against the hammer [-].
    sensor_mass : float
        Mass of the sensor, known and stated [kg].
    modes : int
        Number of elastic modes that the band was chosen for [-].
    band : (low, high)
        Of the analysis [Hz].
    hits : int
        Hits per point, bad ones included [-].
    peak : float
        Median peak force [N].
    level_scatter : float
        Standard deviation of the logarithm of the peak force [-].
    bad_hits : float
        Probability of a hit to be a bad one [-].
    noise : float
        Noise of each channel relative to its peak [-].
    noise_slope : float
        Power of frequency with which its spectral density goes [-].
    bits : int
        Of the converter [-].
    calibration, repeatability : float
        1-sigma of the absolute level and of the frequencies at re-mounting, relative [-].
    position_sigma : float
        Of the hammer's points [m].
    window : float
        Decay rate of the exponential window that the study states [1/s].
    baseline : bool
        Whether the specimen was also tested before the effect was there.
    environment : float or None
        Fluid density that the study states [kg/m3].
    free_surface, bottom : float or None
        Distances of the fluid's surface above and of its bottom below the specimen, stated with the density; None
        is a fluid without end on that side [m].
    breadth : float
        Of a frame's bars, in its plane; of ribs, or of a bracket's legs and gussets [m].
    height : float
        Of ribs, or of a bracket [m].
    rungs : tuple of float
        Where they are in a frame, over its length [-].
    """

    kind: str
    title: str
    length: float
    width: float
    thickness: float
    E: float
    density: float
    poisson: float
    clamped: tuple[str, ...]
    theory: str
    elements: tuple[int, ...]
    tolerances: Tolerances
    alpha: float
    beta: float
    points: tuple[tuple[float, ...], ...]
    sensor: int
    drive: bool
    sensor_sign: int
    sensor_mass: float
    modes: int
    band: tuple[float, float]
    hits: int
    peak: float
    level_scatter: float
    bad_hits: float
    noise: float
    noise_slope: float
    bits: int
    calibration: float
    repeatability: float
    position_sigma: float
    window: float
    baseline: bool
    environment: float | None
    free_surface: float | None = None
    bottom: float | None = None
    breadth: float = 0.0
    height: float = 0.0
    rungs: tuple[float, ...] = ()

    @property
    def size(self) -> tuple[float, ...]:
        """Extents of the model along its axes [m]."""
        return (self.length, self.width) if self.kind == "plate" or self.by_matrices else (self.length,)

    @property
    def by_matrices(self) -> bool:
        """Whether the study models it by matrices."""
        return self.kind in BY_MATRICES

    @property
    def places(self) -> FloatArray:
        """Points as an array, shape (n_points, dim) [m]."""
        return np.array(self.points)

    @property
    def calibrated(self) -> bool:
        """Whether the FRFs have an absolute level."""
        return self.calibration < UNCALIBRATED

    @property
    def mass(self) -> float:
        """Mass of the specimen as drawn [kg]."""
        if self.by_matrices:
            return self.nominal.mass
        return self.density * self.length * self.width * self.thickness

    @property
    def rigidity(self) -> float:
        """Bending stiffness of the whole width as drawn [N m2]."""
        plane = 1.0 - self.poisson**2 if self.kind == "plate" else 1.0
        return self.E * self.width * self.thickness**3 / 12 / plane

    @property
    def sensor_inertia(self) -> float:
        """Rotary inertia of the known sensor about the beam's axis [kg m2].

        It sits 4 mm off the surface; on a solid, whose masses are points, on the surface itself.
        """
        arm = 0.0 if self.kind == "solid" else 0.004
        return self.sensor_mass * (arm + self.thickness / 2) ** 2

    @property
    def nominal(self) -> Body:
        """The body of the drawing, without its sensor."""
        return bare_body(self)

    @property
    def made(self) -> Body:
        """The body made to the drawing, without its sensor: that of the drawing, or one of bricks, or of more."""
        if self.kind in ("ribbed", "bracket"):
            return Block(kind=self.kind, **_drawn(self), breadth=self.breadth, height=self.height)
        if self.kind != "solid":
            return self.nominal
        return Solid(kind="beam", **_drawn(self))

    @cached_property
    def nominal_hz(self) -> tuple[float, ...]:
        """Elastic frequencies of the drawing, one more than ``modes`` [Hz]."""
        body = self.nominal
        omega, _ = body.real_modes(self.modes + 1 + body.rigid_modes)
        return tuple(float(f) for f in omega[body.rigid_modes :] / (2 * np.pi))

    @property
    def decays(self) -> FloatArray:
        """Decay rates that the modeller expects of the modes the band was chosen for [1/s]."""
        omega = 2 * np.pi * np.array(self.nominal_hz[: self.modes])
        rates: FloatArray = 0.5 * (self.alpha + self.beta * omega**2)
        return rates

    @property
    def shear_shift(self) -> float:
        """How much shear and rotary inertia lower the highest nominal mode, relative [-].

        Second-order estimate for a beam with wave number k = (modes -+ 1/2) pi / L, and for a plate with that
        of a plane wave at the mode's frequency: k^2 t^2 / 24 times (1 + E / (kappa G)).
        """
        if self.kind != "plate":
            wave = (self.modes + (-0.5 if self.clamped == ("x0",) else 0.5)) * np.pi / self.length
        else:
            line = self.density * self.thickness * self.width / self.rigidity
            wave = np.sqrt(2 * np.pi * self.nominal_hz[self.modes - 1] * np.sqrt(line))
        return float((wave * self.thickness) ** 2 / 24 * (1 + 2 * (1 + self.poisson) / 0.85))


def bare_body(setup: Setup) -> Body:
    """Return the body of a drawing.

    Parameters
    ----------
    setup : Setup
        Dimensions, material, clamps and expected damping.
    """
    if setup.kind == "frame":
        return Frame(**_drawn(setup), breadth=setup.breadth, rungs=setup.rungs)
    if setup.kind in ("ribbed", "bracket"):
        sizes: dict[str, Any] = {"breadth": setup.breadth, "height": setup.height}
        return Block(kind=setup.kind, **_drawn(setup), **sizes, elements=setup.elements[0])
    kind: type[Plate] | type[Beam] = Plate if setup.kind == "plate" else Beam
    return kind(**_drawn(setup))


def _drawn(setup: Setup) -> dict[str, Any]:
    """Return what every body has of a drawing."""
    named = ("width", "thickness", "clamped", "alpha", "beta", "E", "density", "poisson")
    return {"start": 0.0, "end": setup.length, **{name: getattr(setup, name) for name in named}}


def hit_points(setup: Setup) -> list[int]:
    """Return the indices of the points that are hit."""
    return [i for i in range(len(setup.points)) if setup.drive or i != setup.sensor]
