"""A test in its essentials."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Design:
    """Everything that a change of the test may change.

    Parameters
    ----------
    stations : tuple of int
        Which stations are hit, or seen where the sensor roves.
    modes : int
        Modes in the band [-].
    calibration, repeatability : float
        Relative standard deviations of level and of frequencies at re-mounting [-].
    noise : float
        Standard deviations of the identification over those stated [-].
    position_sigma : float
        Of the hammer's points [m].
    tolerances : tuple of float
        Doubts in the properties of the specimen, in the order of the bench's problem, relative [-].
    damping : float
        Doubt in the damping expected, relative [-].
    damping_known, shapes : bool
        Whether damping and modal constants are informative.
    absolute : bool
        Whether constants have an absolute level.
    baseline : bool
        Whether the same specimen was tested before the effect was there.
    """

    stations: tuple[int, ...]
    modes: int
    calibration: float
    repeatability: float
    noise: float
    position_sigma: float
    tolerances: tuple[float, ...]
    damping: float
    damping_known: bool
    shapes: bool
    absolute: bool
    baseline: bool
