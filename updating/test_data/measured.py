"""The data of a test, in the coordinates of the model: the data side of every comparison."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.display import Displayed, counted
from identification.fading import Fading
from identification.hit_errors import HitErrors

if TYPE_CHECKING:
    import pandas as pd

UNKNOWN_LEVEL = 0.2
"""A calibration worse than this is found by least squares before anything is linearised [-]."""

UNSTATED, NO_PARTNER = -1, -2
"""What stands among the partners for a mode of which nothing is stated, and for one that is stated to have none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Measured(Displayed):
    """Modes of one test as a model can predict them.

    The *constants* are the modal constants phi_response * phi_reference of each FRF: with absolute level for
    a calibrated FRF, up to a factor per mode where only shapes are known. Mass-normalised shapes have a level without
    any FRF: their components phi_response [kg^-1/2], the sign of each mode free, stand in the constants' place.

    Parameters
    ----------
    frequency, frequency_sigma : (n_modes,) arrays
        Natural frequencies and the standard deviations the identification gives them [Hz].
    damping, damping_sigma : (n_modes,) arrays
        Damping ratios and their standard deviations, nan where unknown [-].
    points : (n_points, dim) array
        Test points in model axes [m].
    nodes : tuple of int
        Their node numbers; one that moves in two directions is given twice.
    seen, hit : (n_frf,) int arrays
        Point of the response and of the force of each FRF; ``hit`` is -1 where only a shape is known.
    constants, constants_sigma : (n_frf, n_modes) arrays
        Modal constants and standard deviations, positive along the points' directions [1/kg; where ``hit`` is -1,
        kg^-1/2, or - per mode].
    absolute : bool
        Whether the constants carry absolute level.
    repeated : bool
        Whether the scatter of the constants is known from repeated hits.
    calibration : float
        Relative 1-sigma uncertainty of the level [-].
    repeatability : float
        Relative 1-sigma scatter of the frequencies by re-mounting [-].
    position_sigma : float
        1-sigma uncertainty of the points hit [m].
    title, warnings : str, tuple of str
        For messages.
    rows : (n_frf,) int array, optional
        Row of each constant among the FRFs that were identified; None where there are only modes.
    signs : (n_frf,) array, optional
        Sign by which those FRFs, their transducers' directions made positive, point along the model's axes [-].
    directions : (n_points, 3) array, optional
        Which way each point moves in model axes; left out, along the model's z [-].
    noise : (n_frf, n_modes) array, optional
        The part of ``constants_sigma`` that is each constant's own; None where all of it is [1/kg].
    shared : (n_frf, n_modes, k) array, optional
        The rest: what one standard deviation of each of k independent causes does to all constants [1/kg].
    hit_errors : HitErrors, optional
        What each hit adds to the errors of the constants; None where no hits are known.
    quadrature : (n_modes,) array, optional
        Mean square of the imaginary parts of the constants, which are real for real modes; None where there are hardly
        any [1/kg^2].
    phase, phase_sigma : (n_chains, n_modes) arrays, optional
        By how much the complex constants of each measurement chain are turned, from -pi/2 to pi/2, and its
        standard deviation; ``constants`` are turned back by it [rad].
    channel_group : (n_frf,) int array, optional
        Which chain each FRF was measured by.
    recorded_power : int
        Which derivative of the displacement was recorded: 2 of accelerations, 0 also where it is unknown [-].
    slope, slope_sigma : (n_modes,) arrays, optional
        Relative change of each frequency per newton of the hits' peak force [1/N].
    level : float, optional
        Mean peak force of the hits [N].
    below : int
        How many modes are known to lie below the lowest of these: left out by a band [-].
    written : tuple of str, optional
        Each point as the test writes its degree of freedom, ``5+Z``; left out, by its node alone.
    trusted : (n_frf,) bool array, optional
        Rows by whose shapes modes are paired, where the others spoil them; left out, all.
    partners : (n_modes,) int array, optional
        Rank of the nominal model's mode that each one is stated to be, from 0; `UNSTATED`, or `NO_PARTNER`.
    partner_constants : (n_frf, n_modes) array, optional
        Constants of those modes, by which they are known again in a model that has changed [as ``constants``].
    guessed : bool
        Whether ``constants_sigma`` is a guess: the uncertainty of the shapes was not stated.
    trend, trend_sigma : (n_modes,) arrays, optional
        Relative change of each frequency from the first point to the last in measuring order, and the standard
        deviation of what it has for itself, nan where unknown; None where a test does not rove [-].
    common_trend_sigma : float
        Standard deviation of the error that all of them share [-].
    fading : Fading, optional
        How the noise fades along the records; None where no hits are known.
    unpaired : Measured, optional
        The modes of the same test that have no partner in the nominal model; None where all have one.
    """

    frequency: FloatArray
    frequency_sigma: FloatArray
    damping: FloatArray
    damping_sigma: FloatArray
    points: FloatArray
    nodes: tuple[int, ...]
    seen: IntArray
    hit: IntArray
    constants: FloatArray
    constants_sigma: FloatArray
    absolute: bool
    repeated: bool = True
    calibration: float = 0.02
    repeatability: float = 0.0005
    position_sigma: float = 0.001
    title: str = ""
    warnings: tuple[str, ...] = ()
    rows: IntArray | None = None
    signs: FloatArray | None = None
    directions: FloatArray | None = None
    noise: FloatArray | None = None
    shared: FloatArray | None = None
    hit_errors: HitErrors | None = None
    quadrature: FloatArray | None = None
    phase: FloatArray | None = None
    phase_sigma: FloatArray | None = None
    channel_group: IntArray | None = None
    slope: FloatArray | None = None
    slope_sigma: FloatArray | None = None
    level: float | None = None
    below: int = 0
    written: tuple[str, ...] = ()
    trusted: BoolArray | None = None
    partners: IntArray | None = None
    partner_constants: FloatArray | None = None
    guessed: bool = False
    unpaired: Measured | None = None
    trend: FloatArray | None = None
    trend_sigma: FloatArray | None = None
    common_trend_sigma: float = 0.0
    fading: Fading | None = None
    recorded_power: int = 0

    @property
    def own_sigma(self) -> FloatArray:
        """Standard deviation of each constant that no other shares, (n_frf, n_modes) [1/kg, or - per mode]."""
        return self.constants_sigma if self.noise is None else self.noise

    @property
    def has_shapes(self) -> bool:
        """Whether there are at least two components a shape can be compared in."""
        return len(self.seen) >= 2

    @property
    def sensors(self) -> tuple[int, ...]:
        """Points that carry a response transducer; empty where only shapes are known."""
        return tuple(sorted(set(self.seen.tolist()))) if self.absolute and not self.bare else ()

    @cached_property
    def bare(self) -> bool:
        """Whether the constants are components of shapes, joined to no point of force."""
        return bool((self.hit < 0).all())

    @cached_property
    def roving(self) -> Literal["seen", "hit"]:
        """The end that was moved from point to point: the hammer, or the sensor."""
        seen, hit = np.unique(self.seen), np.unique(self.hit[self.hit >= 0])
        return "seen" if len(seen) > len(hit) else "hit"

    @property
    def fixed(self) -> Literal["seen", "hit"]:
        """The other end: the sensors, or the hammer."""
        return "hit" if self.roving == "seen" else "seen"

    @cached_property
    def sharing(self) -> FloatArray:
        """1 for every two FRFs with a force that have that end in common, (n_frf, n_frf) [-]."""
        point: IntArray = getattr(self, self.fixed)
        return np.asarray((point[:, None] == point) & (self.hit >= 0), dtype=float)

    def same_signs(self, constants: FloatArray) -> FloatArray:
        """Return by what sign each predicted mode, (n_frf, n_modes), is to be taken; a product's is not free [-]."""
        if not self.bare:
            return np.ones(constants.shape[1])
        return np.where(np.sum(self.constants * constants, axis=0) < 0, -1.0, 1.0)

    @cached_property
    def top(self) -> float:
        """Highest measured frequency, of modes with a partner in the model and of those without [Hz]."""
        alone = () if self.unpaired is None else self.unpaired.frequency
        return float(np.max([*self.frequency, *alone], initial=0.0))

    @property
    def level_sigma(self) -> float:
        """Relative standard deviation of the level of the constants; a shape goes with the root of an FRF [-]."""
        return self.calibration / 2 if self.bare else self.calibration

    def modes(self, keep: BoolArray | IntArray) -> Measured:
        """Return the same test with some of its modes."""
        across = (
            "constants",
            "constants_sigma",
            "noise",
            "shared",
            "phase",
            "phase_sigma",
            "partner_constants",
        )
        along = (
            "frequency",
            "frequency_sigma",
            "damping",
            "damping_sigma",
            "slope",
            "slope_sigma",
            "trend",
            "trend_sigma",
            "partners",
            "quadrature",
        )
        columns = {n: getattr(self, n)[:, keep] for n in across if getattr(self, n) is not None}
        rows = {n: getattr(self, n)[keep] for n in along if getattr(self, n) is not None}
        hits = None if self.hit_errors is None else self.hit_errors.modes(keep)
        return replace(self, **rows, **columns, hit_errors=hits)

    def _headline(self) -> str:
        at = f"{counted(len(self.constants), 'channel')} at {counted(len(self.nodes), 'point')}"
        span = f"{self.frequency.min():g} to {self.frequency.max():g} Hz" if len(self.frequency) else ""
        return (
            f"{counted(len(self.frequency), 'mode')} {span}, {at}, {'with' if self.absolute else 'no'} level"
        )

    def _frame(self) -> pd.DataFrame:
        import pandas as pd

        columns = {
            "frequency [Hz]": self.frequency,
            "sigma [Hz]": self.frequency_sigma,
            "damping [%]": 100 * self.damping,
            "sigma [%]": 100 * self.damping_sigma,
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, len(self.frequency) + 1, name="mode"))
