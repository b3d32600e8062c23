"""What a single record of a hit shows: its pulse, a second hit, overload, a channel gone dead."""

from __future__ import annotations

import numpy as np
import scipy.fft
import scipy.signal

from acquisition.arrays import BoolArray, FloatArray

SECOND_HIT = 0.09  # of the peak; hits of a tenth are found even if sampled beside their peak
PROMINENCE = 0.07  # of the peak, above the valleys on both sides
RINGING = 0.6  # a lobe beside a negative one of this part of its height is ringing of a filter


def upright(force: FloatArray) -> FloatArray:
    """Return force records (n_hits, n_samples) without offset and with the pulse upwards [N]."""
    centred = force - np.median(force, axis=-1, keepdims=True)
    peak = np.take_along_axis(centred, np.abs(centred).argmax(axis=-1)[:, None], axis=-1)
    return np.asarray(centred * np.where(peak < 0, -1.0, 1.0), dtype=np.float64)


def pulse_ends(wave: FloatArray, level: float = 0.1) -> tuple[int, int]:
    """Return the first and last sample of the main pulse above a fraction of its peak."""
    top = int(wave.argmax())
    below = wave <= level * wave[top]
    before, after = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    first = int(before[-1]) + 1 if len(before) else 0
    return first, top + int(after[0]) - 1 if len(after) else len(wave) - 1


def pulse_width(wave: FloatArray, rate: float, level: float = 0.1) -> float:
    """Return the length of the main pulse above a fraction of its peak, interpolated between samples [s]."""
    first, last = pulse_ends(wave, level)
    height = level * wave.max()
    early = _crossing(wave, first, first - 1, height)
    late = _crossing(wave, last, last + 1, height)
    return float(last - first + early + late) / rate


def _crossing(wave: FloatArray, inside: int, outside: int, height: float) -> float:
    """Return how far beyond a sample the wave crosses a height [samples]."""
    if not 0 <= outside < len(wave):
        return 0.0
    return float((wave[inside] - height) / (wave[inside] - wave[outside]))


def second_hits(wave: FloatArray) -> list[tuple[int, float]]:
    """Return place [sample] and height relative to the main pulse of every further hit in a record.

    A further hit is a lobe that stands out by itself and has no negative lobe beside it: a force that
    passed a sharp low-pass filter rings with lobes of both signs, about as long as the pulse itself.

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    """
    top = int(wave.argmax())
    peak = float(wave[top])
    quiet = 1.4826 * float(np.median(np.abs(wave)))
    least = max(PROMINENCE * peak, 8 * quiet)
    tops, _ = scipy.signal.find_peaks(wave, height=max(SECOND_HIT * peak, 8 * quiet), prominence=least)
    first, last = pulse_ends(wave)
    reach = max(2, int(np.ceil(1.5 * (last - first + 1))))
    found = []
    for place in np.asarray(tops, dtype=np.int64).tolist():
        beside = wave[max(0, place - reach) : place + reach + 1]
        valley = wave[min(place, top) : max(place, top) + 1].min()
        if valley < wave[place] - least / 2 and -beside.min() < RINGING * wave[place]:
            found.append((place, float(wave[place] / peak)))
    return found


def force_bands(wave: FloatArray, rate: float) -> tuple[float, float]:
    """Return where the spectrum of the force is first 10 and 20 dB below its level at the lowest lines [Hz].

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    rate : float
        Sampling rate [Hz].
    """
    first, last = pulse_ends(wave)
    reach = 2 * (last - first + 1)
    pulse = wave[max(0, first - reach) : last + reach + 1]
    length = scipy.fft.next_fast_len(max(len(wave), 8 * len(pulse)), real=True)
    size = np.abs(scipy.fft.rfft(pulse, length))
    bands = []
    for decibels in (10, 20):
        low = np.flatnonzero(size < size[0] * 10 ** (-decibels / 20))
        bands.append(float(low[0] if len(low) else length // 2) * rate / length)
    return bands[0], bands[1]


def clipped(records: FloatArray) -> BoolArray:
    """Tell which records (..., n_samples) have a flat top: three or more samples at their extreme.

    The broad top of a long pulse is flat too once it is rounded to the converter's steps; there the next
    samples lie a step below, while a clipped wave leaves its top steeply.
    """
    answer = np.zeros(records.shape[:-1], dtype=np.bool_)
    largest = np.abs(records).max(axis=-1, keepdims=True)
    for side in (records, -records):
        extreme = side.max(axis=-1, keepdims=True)
        at_top = (side >= (1 - 1e-6) * extreme) & (extreme > 0.2 * largest)
        flat = at_top[..., :-2] & at_top[..., 1:-1] & at_top[..., 2:]
        for index in map(tuple, np.argwhere(flat.any(axis=-1)).tolist()):
            answer[index] |= _leaves_steeply(side[index], at_top[index])
    return answer


def _leaves_steeply(wave: FloatArray, at_top: BoolArray) -> bool:
    """Tell whether some flat top of three samples or more is no rounded parabola.

    A parabola that rounding has flattened over r samples is some 8 steps lower r samples farther out.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], at_top, [False]]).astype(np.int8)))
    top = float(wave.max())
    steps = np.abs(np.diff(wave[wave > 0.5 * top]))
    step = float(steps[steps > 1e-9 * top].min(initial=top))
    for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        run = stop - start
        outside = [wave[i] for i in (start - run, stop - 1 + run) if 0 <= i < len(wave)]
        if run >= 3 and outside and top - max(outside) > max(1e-3 * top, min(20 * step, 0.1 * top)):
            return True
    return False


def dead_from(records: FloatArray) -> FloatArray:
    """Return the fraction of each record (..., n_samples) after which it is constant though it still moved.

    1 means that it lives to the end or has died away.
    """
    length = records.shape[-1]
    steps = np.abs(np.diff(records, axis=-1))
    moving = steps != 0
    step = np.where(moving, steps, np.inf).min(axis=-1)
    last = np.where(moving.any(axis=-1), length - 1 - moving[..., ::-1].argmax(axis=-1), 0)
    span = max(length // 50, 2)
    size = np.abs(records)
    index = np.clip(last[..., None] - np.arange(1, span + 1), 0, length - 1)
    before = np.take_along_axis(size, index, axis=-1).max(axis=-1)
    alive = before <= np.maximum(1e-3 * size.max(axis=-1), 3 * step)  # died away, or into the last bits
    return np.asarray(np.where(alive | (last > 0.98 * length), 1.0, last / length), dtype=np.float64)


def left_at_end(records: FloatArray) -> FloatArray:
    """Return the r.m.s. of the last twentieth of each record relative to its largest such stretch [-]."""
    length = records.shape[-1] // 20 * 20
    parts = records[..., records.shape[-1] - length :].reshape(*records.shape[:-1], 20, -1)
    power = np.sqrt(np.mean(parts**2, axis=-1))
    return np.asarray(power[..., -1] / np.maximum(power.max(axis=-1), np.finfo(float).tiny), dtype=np.float64)
