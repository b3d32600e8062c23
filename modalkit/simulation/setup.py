"""What is stated of a simulated test, and the resulting setup: points, hits, records and noise."""

from __future__ import annotations

from dataclasses import dataclass

from acquisition import Dof, Geometry, HammerPlan
from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from updating import Measured

PULSE = 1.2
"""Length of the pulse times the end of the band, where nothing is known [-]."""

SAMPLING = 2.56
"""Sampling rate over the highest frequency [-]."""

RESPONSE_NOISE, FORCE_NOISE = 3e-4, 2e-4
"""Noise where nothing is known: of the largest response, and of the force's peak [-]."""

HITS, PEAK = 5, 100.0
"""Hits at a point, and the force's peak [N], where nothing is known."""

TRIGGER = 0.02
"""Share of a record before the hit [-]."""


@dataclass(frozen=True)
class Options:
    """What the user states about the simulated test in place of the study's own; None leaves it.

    Parameters
    ----------
    hits, samples : int, optional
        Hits at each point and samples per record.
    rate : float, optional
        Sampling rate [Hz].
    noise : float, optional
        Noise of each response record, r.m.s. relative to its largest magnitude [-].
    points : int, optional
        How many points, where the study's data do not state which.
    remount : bool
        Whether the structure is mounted anew and the chain calibrated anew: frequencies scatter by the study's
        ``repeatability``, the level by its ``calibration``.
    """

    hits: int | None = None
    samples: int | None = None
    rate: float | None = None
    noise: float | None = None
    points: int | None = None
    remount: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class MeasurementSetup(Displayed):
    """A test without its data.

    Parameters
    ----------
    measured : Measured
        Points in model axes, and which of them is hit and which is observed in every FRF.
    responses, references : tuples of Dof, length n_frf
        What the test calls them.
    signs : (n_frf,) array
        +1 or -1: whether the FRF in the file points along the model's or against it [-].
    geometry : Geometry
        Nodes in test coordinates.
    band : tuple of float
        Band examined [Hz].
    plan : HammerPlan
        How it is hit.
    notes : tuple of str
        What was not the study's.
    """

    measured: Measured
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    signs: FloatArray
    geometry: Geometry
    band: tuple[float, float]
    plan: HammerPlan
    notes: tuple[str, ...] = ()
