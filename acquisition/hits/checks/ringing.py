"""The ringing that a sharp low-pass filter adds to a force, and its removal before hits are counted."""

from __future__ import annotations

import numpy as np
import scipy.fft

from acquisition.arrays import FloatArray
from acquisition.hits.checks.pulse import noise_level, pulse_width

DEPTH = 0.02  # of the peak: shallower negative lobes are let be
LONGEST = 1.5  # pulse widths: a negative lobe that lasts longer is a slow drift, no ringing
NEAR = 12  # pulse widths from the peak within which ringing shows
FINE = 16  # samples per period of the ringing after interpolation, at least


def ringing_period(wave: FloatArray) -> float:
    """Return the period with which a force rings beside its main pulse, 0 if it does not [samples].

    A hammer can only push, so a negative lobe beside the pulse that is not longer than the pulse itself comes
    from a filter, and lasts half a period of what the filter cuts off.

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    """
    top = int(wave.argmax())
    width = pulse_width(wave, 1.0)
    reach = int(np.ceil(NEAR * max(width, 1.0)))
    start = max(0, top - reach)
    near = wave[start : top + reach + 1]
    low = int(near.argmin())
    if -near[low] < max(DEPTH * wave[top], 5 * noise_level(wave)):
        return 0.0
    lobe = pulse_width(np.roll(-near, len(near) // 2 - low), 1.0, level=0.0)
    return 2 * lobe if lobe <= LONGEST * max(width, 2.0) else 0.0


def pushes(wave: FloatArray, rate: float) -> tuple[FloatArray, float]:
    """Return a force without the ringing of a filter, and the rate at which it is now sampled [Hz].

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    rate : float
        Its sampling rate [Hz].
    """
    period = ringing_period(wave)
    clean, factor = without_ringing(wave, period) if period else (wave, 1)
    return clean, rate * factor


def without_ringing(wave: FloatArray, period: float) -> tuple[FloatArray, int]:
    """Return the wave averaged twice over a period of its ringing, and the factor of samples it now has.

    The double average has a double zero at the frequency of the ringing, where a filter cuts off, and leaves
    the impulse of every hit as it is. The wave comes interpolated where a period holds few samples.

    Parameters
    ----------
    wave : (n_samples,) array
        Force record [N].
    period : float
        Period of the ringing [samples].
    """
    factor = int(2 ** np.ceil(np.log2(max(1.0, FINE / period))))
    length = scipy.fft.next_fast_len(len(wave) + int(4 * period) + 4, real=True)
    gain = np.sinc(np.arange(length // 2 + 1) / length * period) ** 2
    spectrum = scipy.fft.rfft(wave, length) * gain
    smooth = scipy.fft.irfft(spectrum, factor * length) * factor
    return np.asarray(smooth[: factor * len(wave)], dtype=np.float64), factor
