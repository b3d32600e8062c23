"""The line shape that a Hann window leaves in FRFs: what each pole of an averaged FRF looks like.

FRFs averaged over blocks of length T with a window w(t) are not samples of H. Where the force is random and about
white, the expected cross spectrum at a line is the integral of H times the power |W|^2 of the window about that line,
and that of the force is the same without H. So E[H1] = E[G_xf] / E[G_ff] is H smeared by |W|^2 (Bendat and Piersol,
Random Data, 4th ed., Sec. 8.5 and 11.5): the transform of the impulse response h(t) times the window's
autocorrelation at the lag t. Analysers also smooth FRFs by a quarter, a half and a quarter of three lines, which is
the lag window (1 + cos) / 2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from acquisition.arrays import ComplexArray

FrfWindow = Literal["none", "hann"]
Kind = Literal["averaged", "smoothed"]
KINDS: tuple[Kind, ...] = ("averaged", "smoothed")
FRF_WINDOWS: tuple[FrfWindow, ...] = ("none", "hann")

_SMALL = 0.3
"""Size of z under which the quotients below are summed as series: beyond it their rounding is under 1e-14 [-]."""
_TERMS = 12
"""Terms of those series: the first one left out is 1e-15 of the sum [-]."""


@dataclass(frozen=True)
class LineShape:
    """How a pole shows in averaged FRFs.

    Parameters
    ----------
    kind : {"averaged", "smoothed"}
        H smeared by the power of a Hann window over each block, as averages over a random force have it; or lines
        smoothed with 1/4, 1/2, 1/4.
    duration : float
        Length of a block, the reciprocal of the distance of lines [s].
    """

    kind: Kind
    duration: float

    def note(self, *, stated: bool) -> str:
        """Return what to say of FRFs that have it.

        Parameters
        ----------
        stated : bool
            Whether the window was stated, and not found from the FRFs.
        """
        law = (
            f"averages over blocks of {self.duration:.3g} s with a Hann window and a random force"
            if self.kind == "averaged"
            else "lines smoothed by a quarter, a half and a quarter, as a Hann window in the lag does"
        )
        how = "" if stated else '; state frf_window = "none" if there was no window'
        return f"the FRFs are fitted as {law}: each pole has that line shape{how}"

    @property
    def silent(self) -> tuple[float, float]:
        """Lags between which the shape leaves under 2 % of an impulse response, over the length of a block [-]."""
        return (0.7, 0.9) if self.kind == "averaged" else (0.46, 0.54)

    def pole(self, distance: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return what stands for 1 / (s - p), and its derivative by p, shapes as ``distance`` [s, s^2].

        Parameters
        ----------
        distance : complex array
            s - p [rad/s].
        """
        z = -distance * self.duration
        value, slope = _averaged(z) if self.kind == "averaged" else _smoothed(z)
        return self.duration * value, self.duration**2 * slope


def _averaged(z: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the integral of exp(z u) r(u) over 0 < u < 1, and its derivative by z [-].

    r(u) = (1 - u) (2 + cos 2 pi u) / 3 + sin(2 pi u) / (2 pi) is the autocorrelation of a Hann window of unit length.
    """
    turn = 2j * np.pi
    value, slope = np.zeros_like(z), np.zeros_like(z)
    grown = np.expm1(z)  # the same after a whole turn
    for shift, ramp, even in ((0.0, 2 / 3, 0.0), (turn, 1 / 6, 0.5 / turn), (-turn, 1 / 6, -0.5 / turn)):
        one, two, three = _quotients(z + shift, grown)
        value += ramp * two + even * one
        slope += ramp * (two - 2.0 * three) + even * (one - two)
    return value, slope


def _quotients(z: ComplexArray, grown: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return g / z, (g - z) / z^2 and (g - z - z^2 / 2) / z^3 of g = e^z - 1."""
    near = np.abs(z) < _SMALL
    inverse = np.asarray(1.0 / np.where(near, 1.0, z), complex)
    one = np.asarray(grown * inverse)
    two = np.asarray((one - 1.0) * inverse)
    three = np.asarray((two - 0.5) * inverse)
    if near.any():
        factor = [np.cumprod(1.0 / np.arange(first, first + _TERMS)) for first in (1, 2, 3)]
        small = z[near][:, None] ** np.arange(_TERMS)
        for quotient, terms, lead in zip((one, two, three), factor, (1.0, 1.0, 0.5), strict=True):
            quotient[near] = small @ (lead * terms)
    return one, two, three


def _smoothed(z: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return 1/4, 1/2, 1/4 of -1 / z at three lines, and its derivative by z [-]."""
    value, slope = np.zeros_like(z), np.zeros_like(z)
    for line, share in ((-1, 0.25), (0, 0.5), (1, 0.25)):
        inverse = 1.0 / (z + 2j * np.pi * line)
        value -= share * inverse
        slope += share * inverse**2
    return value, slope
