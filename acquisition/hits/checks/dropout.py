"""Responses that end before their time: a channel gone dead, a drop-out, what has not decayed."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

PARTS = 100  # stretches of a record whose levels are compared
FALL = 0.05  # of its level: a response that drops below it at once and stays there was cut off
LIVELY = 0.02  # of the largest stretch: only what was above it can be cut off


def dead_from(records: FloatArray) -> FloatArray:
    """Return the fraction of each record (..., n_samples) after which it is dead though it still moved.

    Dead is a record that is constant to its end, or that falls at once to a low level and stays there (a
    broken cable still carries noise). 1 means that it lives to the end or has died away.
    """
    return np.minimum(_constant_from(records), _silent_from(records))


def _constant_from(records: FloatArray) -> FloatArray:
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
    to_the_end = last > min(0.98 * length, length - 3)
    return np.asarray(np.where(alive | to_the_end, 1.0, last / length), dtype=np.float64)


def _silent_from(records: FloatArray) -> FloatArray:
    """Return where the level falls to a twentieth within a stretch or two, after a slow decay, for good."""
    length = records.shape[-1] // PARTS * PARTS
    answer = np.ones(records.shape[:-1])
    if length < 16 * PARTS:
        return answer
    centred = records - records.mean(axis=-1, keepdims=True)
    parts = centred[..., records.shape[-1] - length :].reshape(*records.shape[:-1], PARTS, -1)
    level = np.sqrt(np.mean(parts**2, axis=-1))
    before, past = level[..., 2:-2], level[..., :-4]
    after = np.flip(np.maximum.accumulate(np.flip(level, axis=-1), axis=-1), axis=-1)[
        ..., 4:
    ]  # most from there on
    slow = before > 0.5 * past
    lively = before > LIVELY * level.max(axis=-1, keepdims=True)
    beyond = np.argmax(level, axis=-1)[..., None] < np.arange(2, PARTS - 2)
    cut = slow & lively & beyond & (after < FALL * before)
    found = cut.any(axis=-1)
    return np.asarray(np.where(found, (cut.argmax(axis=-1) + 3) / PARTS, answer), dtype=np.float64)


def dropouts(records: FloatArray) -> FloatArray:
    """Return how long each record (..., n_samples) stands still at most though it moves before and after [-].

    Fraction of the record; 0 where it never stands still for a two-hundredth of the record or 16 samples.
    """
    answer = np.zeros(records.shape[:-1])
    least = max(16, records.shape[-1] // 200)
    for index in np.ndindex(*records.shape[:-1]):
        answer[index] = _stand_still(records[index], least) / records.shape[-1]
    return answer


def _stand_still(record: FloatArray, least: int) -> int:
    """Return the longest stretch of equal samples between two lively ones [samples]."""
    edges = np.flatnonzero(np.diff(record))
    gaps = np.diff(edges)
    step = float(np.abs(np.diff(record)[edges]).min(initial=np.inf))
    floor = max(10 * step, LIVELY * float(np.abs(record).max()))
    longest = 0
    for i in np.flatnonzero(gaps >= least).tolist():
        before = record[max(0, int(edges[i]) - least) : int(edges[i]) + 1]
        after = record[int(edges[i + 1]) + 1 : int(edges[i + 1]) + 1 + least]
        if min(np.ptp(before), np.ptp(after)) > floor:
            longest = max(longest, int(gaps[i]))
    return longest


def left_at_end(records: FloatArray) -> FloatArray:
    """Return the r.m.s. of the last twentieth of each record relative to its largest such stretch [-]."""
    length = records.shape[-1] // 20 * 20
    parts = records[..., records.shape[-1] - length :].reshape(*records.shape[:-1], 20, -1)
    power = np.sqrt(np.mean(parts**2, axis=-1))
    return np.asarray(power[..., -1] / np.maximum(power.max(axis=-1), np.finfo(float).tiny), dtype=np.float64)
