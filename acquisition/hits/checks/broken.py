"""Records in which there is no hit to judge: too short, not finite, or without any force."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.hits.faults import Fault
from acquisition.hits.hammer import Hits

SHORTEST = 32
"""Samples below which a record holds no pulse with its response; doubled, short records that hold both are lost [-]."""

STEADY = 1e-9
"""Change of a force, relative to its largest value, that is rounding of a constant [-]."""


def why_broken(hits: Hits) -> list[Fault | None]:
    """Return for each hit at a point why it cannot be judged, None where it can.

    Parameters
    ----------
    hits : Hits
        Hits at one point.
    """
    length = hits.force.shape[-1]
    if length < SHORTEST:
        plural = "" if length == 1 else "s"
        return [
            Fault("too short", f"a record of {length} sample{plural}; at least {SHORTEST} are needed")
        ] * hits.count
    return [_why(force, motion) for force, motion in zip(hits.force, hits.motion, strict=True)]


def _why(force: FloatArray, motion: FloatArray) -> Fault | None:
    if not (np.isfinite(force).all() and np.isfinite(motion).all()):
        return Fault("broken record", "values that are not finite")
    if np.ptp(force) <= STEADY * np.abs(force).max():
        return Fault("no force", f"the record is constant, {float(force[0]):.3g} N throughout")
    return None
