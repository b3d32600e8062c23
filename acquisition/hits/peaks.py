"""Peaks of a sampled curve, as `scipy.signal.find_peaks` finds them, without the second that loading that takes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray


def find_peaks(
    wave: FloatArray, *, height: float = -np.inf, distance: int = 1, prominence: float = 0.0
) -> IntArray:
    """Return the samples at which a curve has a peak, the middle of a flat top, in rising order (n_peaks,).

    Parameters
    ----------
    wave : (n_samples,) array
        The curve [any].
    height : float
        Least value of a peak [as ``wave``].
    distance : int
        Samples by which peaks are apart at least; the higher of two nearer ones stays.
    prominence : float
        Least fall on both sides before the curve is higher than the peak, or ends [as ``wave``].
    """
    tops = _tops(wave)
    tops = tops[wave[tops] >= height]
    if prominence > 0:
        falls = np.minimum(
            _falls_before(wave, tops), _falls_before(wave[::-1], len(wave) - 1 - tops[::-1])[::-1]
        )
        prominent = tops[falls >= prominence]
    else:
        prominent = tops
    return prominent[np.isin(prominent, _separated(tops, wave, distance))]


def _tops(wave: FloatArray) -> IntArray:
    """Return the middles of all runs of equal samples that are higher than their neighbours."""
    if not len(wave):
        return np.zeros(0, dtype=np.int64)
    last = np.flatnonzero(np.diff(wave) != 0)
    first, last = np.append(0, last + 1), np.append(last, len(wave) - 1)
    level = wave[first]
    rises = level[1:] > level[:-1]
    inner = np.flatnonzero(rises[:-1] & ~rises[1:]) + 1
    return np.asarray((first[inner] + last[inner]) // 2, dtype=np.int64)


def _separated(tops: IntArray, wave: FloatArray, distance: int) -> IntArray:
    keep = np.ones(len(tops), dtype=bool)
    for i in np.argsort(wave[tops])[::-1].tolist() if distance > 1 else ():
        if keep[i]:
            keep &= np.abs(tops - tops[i]) >= distance
            keep[i] = True
    return tops[keep]


def _falls_before(wave: FloatArray, tops: IntArray) -> FloatArray:
    """Return how far a curve lies below each peak at the least since it was higher, or began, (n_tops,) [as ``wave``].

    ``tops`` are all peaks above some height, so that a higher sample before one is beside one of them or at the begin.
    """
    if not len(tops):
        return np.zeros(0)
    valleys = np.minimum.reduceat(wave[: tops[-1] + 1], np.append(0, tops[:-1])).tolist()
    higher: list[tuple[float, float]] = [
        (float(wave[0]), float(wave[0]))
    ]  # peaks, and the lowest before each
    falls = []
    for peak, valley in zip(wave[tops].tolist(), valleys, strict=True):
        low = valley
        while higher and higher[-1][0] <= peak:
            low = min(low, higher.pop()[1])
        higher.append((peak, low))
        falls.append(peak - low)
    return np.array(falls)
