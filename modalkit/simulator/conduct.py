"""What is never quite right in how a test is made: in every trial a little, and no effect to be named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

RINGS = 0.3
"""Share of tests whose hammer rings after its pulse, and of those behind a sharp filter, each by itself [-]."""

NOISY = 0.25
"""Share of tests in which the records of one point are noisier than the others, as by a loose plug [-]."""

DRIFTS = 0.6
"""Largest share of the stated repeatability that comes from temperature during the test, not from re-mounting [-]."""


@dataclass(frozen=True)
class Conduct:
    """How a test falls short of a perfect one.

    Parameters
    ----------
    ringing : float
        Second swing of the hammer over its pulse [-].
    sharp : bool
        Whether the filter in front of the converter rings, as sharp ones do.
    noisy : mapping of int to float
        Rows of points to how many times noisier their records are [-].
    drift : float
        Share of the stated repeatability that is a slow drift from point to point; the rest of its variance is
        that of re-mounting [-].
    """

    ringing: float = 0.0
    sharp: bool = False
    noisy: Mapping[int, float] = field(default_factory=lambda: MappingProxyType({}))
    drift: float = 0.0

    @property
    def mounting(self) -> float:
        """Share of the stated repeatability that is left to re-mounting [-]."""
        return float(np.sqrt(1.0 - self.drift**2))


def draw_conduct(points: int, rng: np.random.Generator) -> Conduct:
    """Draw how a test is made.

    Parameters
    ----------
    points : int
        Number of points that are hit [-].
    rng : numpy.random.Generator
        Source of randomness.
    """
    rings, sharp, noisy = rng.random(3)
    ringing, times, drift = rng.uniform((0.02, np.log(2.0), 0.0), (0.1, np.log(6.0), DRIFTS))
    row = int(rng.integers(points))
    return Conduct(
        ringing=float(ringing) if rings < RINGS else 0.0,
        sharp=bool(sharp < RINGS),
        noisy={row: float(np.exp(times))} if noisy < NOISY else {},
        drift=float(drift),
    )
