"""How fast the noise of the force decays along a record, before the pulse and after it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.hits.checks import noise_level, pulse_ends
from acquisition.hits.hammer import HammerTest

Side = Literal["before", "after"]

FEWEST, PARTS = 100, 10
"""Samples whose noise shows a decay, and stretches whose levels are compared; with fewer samples in each of them, their
levels scatter too much [-]."""

BEFORE, AFTER = 2, 12
"""Pulse widths about the pulse that are not noise: its rise, and its ringing in a filter [-]."""


@dataclass(frozen=True)
class NoiseDecay:
    """The mean decay of the noise of all forces of a test on one side of their pulses.

    Parameters
    ----------
    rate, error : float
        The decay and its standard error [1/s].
    freedom : int
        Degrees of freedom of the error [-].
    """

    rate: float
    error: float
    freedom: int


def noise_decay(test: HammerTest, side: Side) -> NoiseDecay | None:
    """Return the decay of the noise on one side of the pulses; None where there is no noise to show it.

    There is noise where it exceeds a millionth of the peak and a few steps of the converter over 100 samples. What is
    constant up to an end of the record was set so, by a force window for instance, and is no noise.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    side : {"before", "after"}
        The pulses.
    """
    found = [
        one
        for point in test.points
        for force in np.asarray(point.force, dtype=np.float64)
        if np.isfinite(force).all() and (one := _rate(force, test.rate, side)) is not None
    ]
    if not found:
        return None
    rates, spans, squares, freedom = (np.array(column) for column in zip(*found, strict=True))
    share = spans / spans.sum()
    return NoiseDecay(float(share @ rates), float(np.sqrt(share**2 @ squares)), int(freedom.sum()))


def falls_faster(test: HammerTest, decay: float) -> bool:
    """Return whether behind every pulse the noise is gone sooner than with a window: the force has one of its own.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    decay : float
        Decay rate of the window [1/s].
    """
    return all(
        _falls_faster(np.asarray(force, dtype=np.float64), decay / test.rate)
        for point in test.points
        for force in point.force
    )


def _falls_faster(force: FloatArray, fade: float) -> bool:
    """Return it for one force; steps of the converter are no noise, and their lack is no window."""
    first, last = pulse_ends(np.abs(force - np.median(force)))
    width = last - first + 1
    before, start = force[: max(first - BEFORE * width, 0)], last + AFTER * width
    length = (len(force) - start) // PARTS
    if len(before) < FEWEST // PARTS or length < FEWEST // PARTS:
        return False
    parts = force[start : start + PARTS * length].reshape(PARTS, length)
    level = noise_level(before - np.median(before))
    left = np.array([noise_level(part - np.median(part)) for part in parts])
    delay = start + (np.arange(PARTS) + 0.5) * length - len(before) / 2
    expected = level * np.exp(-fade * delay)
    steps = np.abs(np.diff(before))
    step = float(steps[steps > 0].min(initial=np.inf))
    return bool(np.any((expected > 3 * step) & (left < expected / 3)))


def _rate(force: FloatArray, rate: float, side: Side) -> tuple[float, float, float, int] | None:
    """Return the decay of the noise of one force [1/s], its weight, squared error and degrees of freedom."""
    size = np.abs(force - np.median(force))
    rest, peak = _noise(force, size, side), float(size.max())
    if len(rest) < FEWEST:
        return None
    parts = rest[: len(rest) // PARTS * PARTS].reshape(PARTS, -1)
    level = np.sqrt(np.mean((parts - parts.mean(axis=1, keepdims=True)) ** 2, axis=1))
    steps = np.abs(np.diff(rest))
    step = float(steps[steps > 0].min(initial=np.inf))
    if level[0] < 3 * step and level[0] < 1e-3 * peak:
        return None
    above_noise = level > max(step, 1e-6 * peak) if step < level[0] / 30 else level > 3 * step
    count = int(above_noise.sum())
    if count < 3:
        return None
    time = (np.arange(PARTS) * parts.shape[1] / rate)[above_noise]
    line = np.polyfit(time, np.log(level[above_noise]), 1)
    left = np.log(level[above_noise]) - np.polyval(line, time)
    scatter = max(float(left @ left) / (count - 2), 0.5 / parts.shape[1])
    spread = float(((time - time.mean()) ** 2).sum())
    return -float(line[0]), float(np.ptp(time)) ** 2, scatter / spread, count - 2


def _noise(force: FloatArray, size: FloatArray, side: Side) -> FloatArray:
    """Return the samples on one side of the pulse, without what is constant up to the record's end there."""
    first, last = pulse_ends(size)
    width = last - first + 1
    rest = force[: max(first - BEFORE * width, 0)] if side == "before" else force[last + AFTER * width :]
    outwards = rest[::-1] if side == "before" else rest
    moves = np.flatnonzero(np.diff(outwards))
    kept = outwards[: int(moves[-1]) + 1] if len(moves) else outwards[:0]
    return kept[::-1] if side == "before" else kept
