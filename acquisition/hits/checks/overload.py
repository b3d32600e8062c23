"""Overload: flat tops, sharp or rounded by a filter, and records that end at the converter's limit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.ndimage

from acquisition.arrays import BoolArray, FloatArray
from acquisition.hits.checks.pulse import noise_level, pulse_width
from acquisition.hits.peaks import find_peaks

FLAT = 0.53  # width at 90 % over width at 50 % of a plateau: clean pulses at most 0.51, cut at 90 % 0.56
FLAT_WAVE = 0.56  # the same of a wave of a response: a sine has 0.48
SAME_LEVEL = 0.03  # relative spread of the tops of waves that end at one limit
DIFFERENT = 0.02  # relative difference of the energies of records that are not copies of each other
FINE_STEP = 1e-4  # of the limit: with steps as fine, two equal largest values are no accident
EQUAL = 1e-6  # of the extreme: samples so near to it are at it
STEEP = 0.1  # of the top: a pair of equal samples is a clipped pulse's if it is so much lower two samples farther out

PAIR_STEP = 3e-6
"""Steps of a record, relative to its top, from which two equal samples may be a clipped top: two samples of a round
one that falls steeply agree as well in one hit of 30 000 [-]; with steps ten times as large, in one of 3 000."""


def clipped(records: FloatArray, *, least: int = 3) -> BoolArray:
    """Return which records (..., n_samples) have a flat top: three or more samples at their extreme.

    The broad top of a long pulse is flat too once it is rounded to the converter's steps; there the next
    samples lie a step below, while a clipped wave leaves its top steeply.

    Parameters
    ----------
    records : (..., n_samples) array
        Forces or responses, any window taken back [any].
    least : int
        Samples that make a top: 3, or 2 for a short pulse, which then must be steep and finely resolved.
    """
    answer = np.zeros(records.shape[:-1], dtype=np.bool_)
    largest = np.abs(records).max(axis=-1, keepdims=True)
    for side in (records, -records):
        extreme = side.max(axis=-1, keepdims=True)
        at_top = (side >= (1 - EQUAL) * extreme) & (extreme > 0.2 * largest)
        flat = at_top[..., :-1] & at_top[..., 1:]
        for index in map(tuple, np.argwhere(flat.any(axis=-1)).tolist()):
            answer[index] |= _leaves_steeply(side[index], at_top[index], least)
    return answer


def _leaves_steeply(wave: FloatArray, at_top: BoolArray, least: int) -> bool:
    """Return whether some flat top of as many samples or more is no rounded parabola.

    A parabola that rounding has flattened over r samples is some 8 steps lower r samples farther out.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], at_top, [False]]).astype(np.int8)))
    runs = [(i, j) for i, j in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True) if j - i >= least]
    if not runs:
        return False
    top = float(wave.max())
    steps = np.abs(np.diff(wave[wave > 0.5 * top]))
    step = float(steps[steps > 1e-9 * top].min(initial=top))
    for start, stop in runs:
        run = stop - start
        outside = [wave[i] for i in (start - run, stop - 1 + run) if 0 <= i < len(wave)]
        lower = top - max(outside, default=top)
        if run == 2 and lower > STEEP * top and _finest_step(wave) < PAIR_STEP * top:
            return True
        if run >= 3 and lower > max(1e-3 * top, min(20 * step, 0.1 * top)):
            return True
    return False


def _finest_step(wave: FloatArray) -> float:
    """Return the smallest difference of two values of a record that are not the same [as ``wave``]."""
    top = float(np.abs(wave).max())
    steps = np.diff(np.unique(wave))
    return float(steps[steps > 1e-9 * top].min(initial=top))


def flat_pulse(wave: FloatArray) -> bool:
    """Return whether a force pulse has a flat top that a filter has rounded.

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    """
    half = pulse_width(wave, 1.0, level=0.5)
    if half < 10 or noise_level(wave) > 0.03 * wave.max():
        return False
    smooth = scipy.ndimage.gaussian_filter1d(wave, half / 16, mode="nearest")
    top = int(smooth.argmax())
    near = smooth[max(0, top - int(half)) : top + int(half) + 1]
    plateau = np.minimum(
        smooth, np.median(near[near > 0.85 * near.max()])
    )  # without overshoot at its corners
    least = FLAT + 1.5 * noise_level(wave) / wave.max()
    return bool(pulse_width(plateau, 1.0, 0.9) > least * pulse_width(plateau, 1.0, 0.5))


def flat_waves(record: FloatArray) -> bool:
    """Return whether the largest waves of a response end flat and at one level, as after clipping and filtering.

    Parameters
    ----------
    record : (n_samples,) array
        Response record [any].
    """
    centred = record - record.mean()
    size = np.abs(centred)
    tops = find_peaks(size, height=0.85 * size.max(), distance=3)
    if len(tops) < 4:
        return False
    swings = {start: rest for start, *rest in (_swing(centred, int(top)) for top in tops[:40])}
    level, flatness, lasting = np.array(list(swings.values())).T
    clear = (lasting >= 10) & (flatness > FLAT_WAVE)
    if clear.sum() < 4:
        return False
    limit = float(np.median(level[clear]))
    reaching = (lasting >= 10) & (
        level > (1 - SAME_LEVEL) * limit
    )  # these should all be flat, and none higher
    together = clear & (np.abs(level / limit - 1) < SAME_LEVEL)
    return bool(together.sum() >= max(4, 0.7 * reaching.sum()))


def _swing(centred: FloatArray, top: int) -> tuple[int, float, float, int]:
    """Return start, plateau, flatness and length of the half-wave around an extreme."""
    wave = centred * np.sign(centred[top])
    below = wave <= 0
    before, after = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    start = int(before[-1]) + 1 if len(before) else 0
    stop = top + int(after[0]) if len(after) else len(wave)
    lobe = wave[start:stop]
    plateau = float(np.median(lobe[lobe > 0.85 * lobe.max()]))
    return start, plateau, float((lobe > 0.9 * plateau).sum() / (lobe > 0.5 * plateau).sum()), stop - start


def at_common_limit(records: Sequence[FloatArray]) -> BoolArray:
    """Return which records of one channel end exactly at the same largest value, which is then its limit.

    Two records of different energy whose largest values agree to the last step are no accident if the steps
    are fine; with coarse steps it takes three.

    Parameters
    ----------
    records : sequence of (n_samples,) arrays
        All records of one channel [any].
    """
    tops = np.array([np.abs(record).max() for record in records])
    limit = float(tops.max(initial=0.0))
    reached = tops >= (1 - 1e-6) * limit
    if limit <= 0 or reached.sum() < 2:
        return np.zeros(len(records), dtype=np.bool_)
    there = [records[i] for i in np.flatnonzero(reached).tolist()]
    energy = np.array([record @ record for record in there])
    steps = np.diff(np.unique(np.abs(there[0])))
    steps = steps[steps > 1e-9 * limit]
    fine = len(steps) > 0 and float(steps.min()) < FINE_STEP * limit
    differ = np.ptp(energy) > DIFFERENT * energy.max()  # copies of one record give no information
    return np.asarray(reached & bool(differ and reached.sum() >= (2 if fine else 3)), dtype=np.bool_)
