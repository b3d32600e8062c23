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
    tops = _apart(tops[wave[tops] >= height], wave, distance)
    if prominence <= 0:
        return tops
    return np.array([top for top in tops.tolist() if _fall(wave, top) >= prominence], dtype=np.int64)


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


def _apart(tops: IntArray, wave: FloatArray, distance: int) -> IntArray:
    keep = np.ones(len(tops), dtype=bool)
    for i in np.argsort(wave[tops])[::-1].tolist() if distance > 1 else ():
        if keep[i]:
            keep &= np.abs(tops - tops[i]) >= distance
            keep[i] = True
    return tops[keep]


def _fall(wave: FloatArray, top: int) -> float:
    """Return the smaller of the falls on either side of a peak."""
    higher = np.flatnonzero(wave > wave[top])
    after = int(np.searchsorted(higher, top))
    low = higher[after - 1] if after else 0
    high = higher[after] if after < len(higher) else len(wave)
    return float(wave[top] - max(wave[low : top + 1].min(), wave[top:high].min()))
