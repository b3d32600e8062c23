"""What the user may state about the treatment of records."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from acquisition import ESTIMATORS, FRF_WINDOWS, Estimator, FrfWindow, InputError

FASTEST = 1e6
"""Fastest decay of a window [1/s]: it is over within one sample of any hammer test."""

HitName = tuple[str, int]


@dataclass(frozen=True)
class ProcessingOptions:
    """How files become FRFs.

    Parameters
    ----------
    decay : float
        Decay rate of an exponential window applied before the files were written, where they do not say it
        themselves [1/s].
    window_on : {"both", "responses"}, optional
        Which records that window was applied to; left out: as the noise of the force shows.
    window : float
        Decay rate of a further exponential window, applied here; 0 for none [1/s].
    estimator : {"H1", "H2", "Hv"}
        FRF estimator.
    use, leave : tuples of (str, int)
        Hits to use or to leave out against the proposal: the point as printed, ``"12+Z"``, and the number of
        the hit at it, from 1.
    layout : path, optional
        Rate, units and points of column text.
    sensor_masses : tuple of (str, float)
        Accelerometers whose mass is taken out of the FRFs: where, as printed, and its mass [kg].
    frf_window : {"none", "hann"}, optional
        Window on the blocks that FRFs in the files were averaged over; left out: as the FRFs show it.
    references : tuple of str
        Degrees of freedom, as printed, whose forces are used; left out, all.

    Raises
    ------
    InputError
        If a decay is negative, or the estimator or the window unknown.
    """

    decay: float = 0.0
    window_on: Literal["both", "responses"] | None = None
    window: float = 0.0
    estimator: Estimator = "H1"
    use: tuple[HitName, ...] = ()
    leave: tuple[HitName, ...] = ()
    layout: Path | str | None = None
    sensor_masses: tuple[tuple[str, float], ...] = ()
    references: tuple[str, ...] = ()
    frf_window: FrfWindow | None = None

    def __post_init__(self) -> None:
        """Check the entries."""
        object.__setattr__(self, "layout", None if self.layout is None else Path(self.layout))
        if not (0 <= self.decay <= FASTEST and 0 <= self.window <= FASTEST):
            raise InputError(
                f"windows of {self.decay:g} and {self.window:g} 1/s: decay rates must be between 0 and {FASTEST:g} 1/s"
            )
        if self.estimator not in ESTIMATORS:
            raise InputError(f"unknown estimator {self.estimator!r}; use {', '.join(ESTIMATORS)}")
        if self.frf_window not in (None, *FRF_WINDOWS):
            raise InputError(f"unknown window of FRFs {self.frf_window!r}; use {', '.join(FRF_WINDOWS)}")


def hit_name(text: str) -> HitName:
    """Return point and number of a hit written ``12+Z:3``.

    Raises
    ------
    InputError
        If it is written otherwise.
    """
    point, colon, number = text.rpartition(":")
    if not colon or not number.strip().isdecimal():
        raise InputError(f"a hit is written POINT:NUMBER, as 12+Z:3, not {text!r}")
    return point.strip(), int(number)


def sensor_mass(text: str) -> tuple[str, float]:
    """Return place and mass [kg] of an accelerometer written ``25+Z=0.0086`` or ``25+Z=8.6g``.

    Raises
    ------
    InputError
        If it is written otherwise.
    """
    place, equals, number = text.rpartition("=")
    try:
        mass = float(number)
    except ValueError:
        from acquisition.si_units import si_value  # loads a table of units: not for plain numbers

        try:
            mass = float(si_value(number, "kg"))
        except ValueError:
            mass = float("nan")
    if not equals or not mass >= 0 or mass == float("inf"):
        raise InputError(
            f"a sensor is written POINT=MASS in kg or with its unit, as 25+Z=0.0086 or 25+Z=8.6g, not {text!r}"
        )
    return place.strip(), mass
