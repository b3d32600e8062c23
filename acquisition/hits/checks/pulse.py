"""The pulse of a single force record: which way up, how long, how much noise, which band it excites."""

from __future__ import annotations

import numpy as np
import scipy.fft

from acquisition.arrays import FloatArray
from acquisition.hits.checks.drift import without_drift


def upright(force: FloatArray) -> FloatArray:
    """Return force records (n_hits, n_samples) without offset and drift and with the pulse upwards [N]."""
    centred = without_drift(force)
    peak = np.take_along_axis(centred, np.abs(centred).argmax(axis=-1)[:, None], axis=-1)
    return np.asarray(centred * np.where(peak < 0, -1.0, 1.0), dtype=np.float64)


def noise_level(wave: FloatArray) -> float:
    """Return the standard deviation of a record outside its pulse, from the median magnitude [as ``wave``]."""
    return 1.4826 * float(np.median(np.abs(wave)))


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
    if not 0 <= outside < len(wave) or wave[inside] == wave[outside]:
        return 0.0
    return float((wave[inside] - height) / (wave[inside] - wave[outside]))


def force_bands(wave: FloatArray, rate: float) -> tuple[float, float]:
    """Return where the spectrum of the force is first 10 and 20 dB below its level at the lowest lines [Hz].

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    rate : float
        Sampling rate [Hz].
    """
    frequency, size = pulse_spectrum(wave, rate)
    bands = []
    for decibels in (10, 20):
        low = np.flatnonzero(size < size[0] * 10 ** (-decibels / 20))
        bands.append(float(frequency[low[0] if len(low) else -1]))
    return bands[0], bands[1]


def pulse_spectrum(wave: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """Return lines [Hz] and the magnitude of the spectrum of a pulse alone, without the noise of the rest [N].

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
    return np.asarray(np.arange(len(size)) * rate / length), size
