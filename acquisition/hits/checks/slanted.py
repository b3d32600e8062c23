"""The tops of clipped pulses in records that were windowed afterwards: they fall by one ratio from sample to sample."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from acquisition.arrays import FloatArray

LONGEST_TOP = 64
"""Samples of a top that are followed; a longer top determines its rate no better; a shorter limit would lose accuracy
[-].
"""

BEND = 2e-6
"""Change of the logarithm's slope from sample to sample that is rounding: single precision has 3e-7; with ten times
as much, the round top of a long pulse with little noise is taken for a clipped one [-]."""

ZERO = 1e-9
"""Part of the top below which a sample counts as zero, whose logarithm there is none [-]."""

FASTEST_FALL = 20.0
"""Decay over a record, in nepers, beyond which no window is used: e^-20 is below every converter's step [-]."""


def top_decay(
    forces: Iterable[FloatArray], rate: float, *, about: tuple[float, float] | None = None
) -> float | None:
    """Return the rate at which tops of clipped pulses fall, None if there are none such [1/s].

    A clipped top is level; multiplied by a window exp(-d t) it falls by the ratio exp(-d / rate) from each sample to
    the next, which no round top does. Its first sample is the largest of the record.

    Parameters
    ----------
    forces : iterable of (n_samples,) arrays
        Records as they were stored, offset included [N].
    rate : float
        Sampling rate [Hz].
    about : tuple of float, optional
        Between which rates it must lie, as the noise has it; then three samples of a top are enough [1/s]. Left out:
        above zero and below 20 nepers a record, and four samples are needed.
    """
    least = 4 if about is None else 3
    found = [top for force in forces if (top := _top(force, rate, about)) is not None and top[0] >= least]
    return max(found)[1] if found else None


def _top(force: FloatArray, rate: float, about: tuple[float, float] | None) -> tuple[int, float] | None:
    """Return how many samples a slanted top has and its rate [1/s], None where the top is round or level."""
    size = np.abs(force)
    first = int(size.argmax())
    top = size[first : first + LONGEST_TOP]
    if len(top) < 3 or top[0] == 0:
        return None
    steps = -np.diff(np.log(np.maximum(top, ZERO * top[0])))
    bent = np.abs(np.diff(steps)) > BEND
    straight = int(bent.argmax()) if bent.any() else len(bent)
    if straight == 0:
        return None
    fall = float(steps[: straight + 1].mean()) * rate
    low, high = about or (0.0, FASTEST_FALL * rate / len(force))
    return (straight + 2, fall) if fall * len(force) > BEND * rate and low < fall < high else None
