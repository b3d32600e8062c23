"""What the modeller and the test engineer believe and state: the contents of the study file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modalkit.blind.bodies.beam import Beam


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
    title : str
        Neutral title.
    length, width, thickness : float
        Nominal dimensions [m].
    E, density, poisson : float
        Nominal material [Pa], [kg/m3], [-].
    clamped : bool
        Cantilever, or free-free on soft springs.
    theory : {"timoshenko", "euler-bernoulli"}
        Of the model.
    elements : int
        Of the model [-].
    tolerances : Tolerances
        Stated, and true: the specimen is drawn from them.
    alpha, beta : float
        Rayleigh damping the modeller expects [1/s], [s].
    points : tuple of float
        Where the hammer hits, from the start of the model [m].
    sensor : int
        Index of the point under the accelerometer [-].
    drive : bool
        Whether the sensor's own point is hit too.
    sensor_sign : int
        -1 where the sensor looks against the hammer [-].
    sensor_mass : float
        Mass of the sensor, known and stated [kg].
    modes : int
        Number of bending modes that the band was chosen for [-].
    band : (low, high)
        Of the analysis [Hz].
    hits : int
        Good hits per point [-].
    noise : float
        Noise of each channel relative to its peak [-].
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
    """

    title: str
    length: float
    width: float
    thickness: float
    E: float
    density: float
    poisson: float
    clamped: bool
    theory: str
    elements: int
    tolerances: Tolerances
    alpha: float
    beta: float
    points: tuple[float, ...]
    sensor: int
    drive: bool
    sensor_sign: int
    sensor_mass: float
    modes: int
    band: tuple[float, float]
    hits: int
    noise: float
    bits: int
    calibration: float
    repeatability: float
    position_sigma: float
    window: float
    baseline: bool
    environment: float | None

    @property
    def sensor_inertia(self) -> float:
        """Rotary inertia of the known sensor about the beam's axis, 4 mm off the surface [kg m2]."""
        return self.sensor_mass * (0.004 + self.thickness / 2) ** 2

    @property
    def nominal(self) -> Beam:
        """The beam of the drawing, without its sensor."""
        return Beam(
            start=0.0,
            end=self.length,
            width=self.width,
            thickness=self.thickness,
            E=self.E,
            density=self.density,
            poisson=self.poisson,
            clamped=self.clamped,
            alpha=self.alpha,
            beta=self.beta,
        )

    @property
    def nominal_hz(self) -> tuple[float, ...]:
        """Bending frequencies of the drawing, one more than ``modes`` [Hz]."""
        skip = 0 if self.clamped else 2
        omega, _ = self.nominal.real_modes(self.modes + 1 + skip)
        return tuple(float(f) for f in omega[skip:] / (2 * np.pi))

    @property
    def shear_shift(self) -> float:
        """How much shear and rotary inertia lower the highest nominal mode, relative [-].

        Second-order estimate for a beam with wave number k = (modes -+ 1/2) pi / L: k^2 t^2 / 24 times
        (1 + E / (kappa G)).
        """
        wave = (self.modes + (-0.5 if self.clamped else 0.5)) * np.pi / self.length
        return float((wave * self.thickness) ** 2 / 24 * (1 + 2 * (1 + self.poisson) / 0.85))
