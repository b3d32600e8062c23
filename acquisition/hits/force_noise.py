"""Forces without the noise of the record around their pulses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from acquisition.hits.checks import noise_level, pulse_ends, without_drift
from acquisition.hits.force_tail import with_tails
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.warned import Consequential

COUNTS = 0.01
"""Error of FRFs by the noise of the forces, relative to the pulse, from which that noise is taken out: what all hits
together leave of its scatter, or its square, by which H1 is too low [-]. Below, the ringing that is cut off with the
noise, alike in all hits, errs by as much. Ten times as much, damping from records ten times as long as the ringing is a
third too low."""

STANDS_OUT = 6.0
"""Standard deviations of noise, over the width of a pulse, from which there is force, as no long record has [-]."""


def pulses_alone(test: HammerTest, *, averaged: bool = True) -> tuple[HammerTest, tuple[str, ...]]:
    """Return a test whose forces have no drift, and no noise beside their pulses where it counts; what was done.

    Forces that a window cut off while they rang ring on, see `with_tails`.

    At every spectral line the force holds the noise of its whole record, while the pulse is over at once. In a record
    far longer than the ringing this noise reaches the size of the pulse; then it makes the few lines of a peak go up
    and down at random, and damping is wrong. Noise of the responses does no such harm: it is independent of the
    ringing, and all lines together hold it against the model.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit, with their window stated.
    averaged : bool
        Whether all hits are averaged; else each is used by itself, and none averages the noise of another.
    """
    test, rung = with_tails(test)
    fade = test.decay / test.rate
    level = [without_drift(p.force, fade=fade) for p in test.points]
    pulses = [np.array([_around_pulse(wave) for wave in waves]) for waves in level]
    powers = np.array(
        [
            _powers(wave, near)
            for waves, spans in zip(level, pulses, strict=True)
            for wave, near in zip(waves, spans, strict=True)
        ]
    )
    impulse, noise = powers.sum(axis=0)
    bias = noise / max(impulse, np.finfo(float).tiny)
    if max(np.sqrt(bias / (len(powers) if averaged else 1)), bias) <= COUNTS:
        points = tuple(_drifting(p, waves) for p, waves in zip(test.points, level, strict=True))
        return replace(test, points=points), rung
    alone = [replace(p, force=w * near) for p, w, near in zip(test.points, level, pulses, strict=True)]
    length = float(np.median(np.concatenate([near.sum(axis=-1) for near in pulses]))) / test.rate
    text = (
        f"{test.source}: noise of the force, summed over records of {test.duration:.3g} s, reaches "
        f"{100 * np.sqrt(bias):.2g} % of a pulse; the force is set to zero outside {length:.2g} s about each pulse"
    )
    return replace(test, points=tuple(alone)), (*rung, Consequential(text))


def _drifting(hits: Hits, level: FloatArray) -> Hits:
    """Return the hits without the drift of their forces; as they are where there is none."""
    offset = np.median(hits.force, axis=-1, keepdims=True)
    return hits if np.array_equal(level, hits.force - offset) else replace(hits, force=level)


def _around_pulse(wave: FloatArray) -> BoolArray:
    """Return which samples of a force belong to its pulse, to further ones, or to their ringing in a filter."""
    size = np.abs(wave)
    if not (np.isfinite(wave).all() and wave.any()):
        return np.ones(len(wave), dtype=np.bool_)
    first, last = pulse_ends(size)
    width = last - first + 1
    mean = np.convolve(wave, np.ones(width) / np.sqrt(width), mode="same")
    force = np.flatnonzero(np.abs(mean) > STANDS_OUT * noise_level(mean))
    start, stop = min([first, *force]) - width, max([last, *force]) + width
    place = np.arange(len(wave))
    return np.asarray((place >= start) & (place <= stop))


def _powers(wave: FloatArray, near: BoolArray) -> tuple[float, float]:
    """Return the powers of the pulse and of the noise beside it at a spectral line [N^2]: H1 adds those of all hits."""
    if not np.isfinite(wave).all():
        return 0.0, 0.0
    return float(wave[near].sum()) ** 2, float(np.sum(wave[~near] ** 2))
