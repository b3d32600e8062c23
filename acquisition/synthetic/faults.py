"""What goes wrong between the structure and the file."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

CLIP_AT = 0.6  # of the record's own largest magnitude
CUT_AT = 0.2  # of the record's length


def clip(records: FloatArray) -> FloatArray:
    """Return the records with their peaks cut off at a fraction of the largest magnitude of each."""
    limit = CLIP_AT * np.abs(records).max(axis=-1, keepdims=True)
    return np.asarray(np.clip(records, -limit, limit), dtype=np.float64)


def cut_off(records: FloatArray) -> FloatArray:
    """Return the records as if the channel had gone dead early on: zeros to the end."""
    kept = np.array(records, dtype=np.float64)
    kept[..., int(CUT_AT * records.shape[-1]) :] = 0.0
    return kept


def coloured(white: FloatArray, slope: float) -> FloatArray:
    """Return noise whose power spectral density goes as frequency to a power, of the same expected r.m.s.

    Parameters
    ----------
    white : array
        White noise along the last axis [any].
    slope : float
        The power; 0 returns the noise as it is [-].
    """
    if slope == 0.0:
        return white
    length = white.shape[-1]
    line = np.fft.rfftfreq(length, 1 / length)
    gain = np.maximum(line, 1.0) ** (slope / 2)
    both = np.where((line == 0) | (2 * line == length), 1.0, 2.0)
    gain = gain / np.sqrt((both * gain**2).sum() / length)
    return np.asarray(np.fft.irfft(gain * np.fft.rfft(white, axis=-1), length, axis=-1), dtype=np.float64)


def quantise(records: FloatArray, bits: int, full_scale: FloatArray | float) -> FloatArray:
    """Return the records rounded to the steps of a converter.

    Parameters
    ----------
    records : array
        Samples along the last axis [any].
    bits : int
        Resolution, sign included.
    full_scale : array that broadcasts to ``records``
        Largest magnitude the channel can take [as ``records``]; the range used is the next one that makes
        the step a power of two.
    """
    scale = np.where(np.asarray(full_scale) > 0, full_scale, 1.0)
    step = 2.0 ** np.ceil(np.log2(scale / 2 ** (bits - 1)))
    largest = 2.0 ** (bits - 1) - 1
    return np.asarray(np.clip(np.round(records / step), -largest, largest) * step, dtype=np.float64)
