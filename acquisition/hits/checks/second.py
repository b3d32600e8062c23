"""Further hits in a record: lobes that stand apart, and shoulders on the flanks of the main pulse."""

from __future__ import annotations

import numpy as np
import scipy.ndimage

from acquisition.arrays import FloatArray
from acquisition.hits.checks.pulse import noise_level, pulse_width
from acquisition.hits.checks.ringing import ringing_period, without_ringing
from acquisition.hits.peaks import find_peaks

SECOND_HIT = 0.075  # of the peak; a hit of a tenth is found even if smoothed or sampled beside its peak
VALLEY = 0.04  # of the peak, between the lobe and the main pulse
NEAREST = 0.6  # pulse widths from the peak: what comes sooner is the contact's own shape
SHOULDER = 0.12  # of peak / width: how much the slope must relax and steepen again
SHOULDER_LEVEL = 0.06  # of the peak: what lies lower is no shoulder
OWN_RINGING = 0.6  # a lobe beside a negative one of this part of its height is left-over ringing
SLOPE = 3  # samples that have a slope which can bend
ENOUGH = 12  # samples per pulse from which shoulders can be detected


def second_hits(wave: FloatArray) -> list[tuple[int, float]]:
    """Return place [sample] and height relative to the main pulse of every further hit in a record.

    Ringing of a low-pass filter is averaged away first; then a further hit is a lobe that stands apart from
    the main pulse, or a shoulder on its tail. A bulge closer to the peak than 0.6 of the pulse's width is
    the shape of the contact: the hammer has not left yet.

    Parameters
    ----------
    wave : (n_samples,) array
        Force record, pulse upwards and without offset [N].
    """
    period = ringing_period(wave)
    clean, factor = without_ringing(wave, period) if period else (wave, 1)
    width = pulse_width(clean, 1.0)
    light = max(0.7, width / 12)  # against noise; what was averaged over a period needs no more
    smooth = clean if period else scipy.ndimage.gaussian_filter1d(clean, light, mode="nearest")
    found = _lobes(smooth, period * factor)
    if width >= ENOUGH:
        found += [h for h in _shoulders(clean, width) if all(abs(h[0] - f[0]) > width / 2 for f in found)]
    return [(place // factor, height) for place, height in found]


def _lobes(wave: FloatArray, period: float) -> list[tuple[int, float]]:
    """Return the lobes that stand apart from the main pulse."""
    top, width = int(wave.argmax()), pulse_width(wave, 1.0)
    peak, quiet = float(wave[top]), noise_level(wave)
    least = max(SECOND_HIT * peak, 6 * quiet)
    padded = np.concatenate([[wave.min()], wave, [wave.min()]])
    tops = find_peaks(padded, height=least, prominence=max(VALLEY * peak, 5 * quiet))
    reach = int(np.ceil(period))
    found = []
    for place in (tops - 1).tolist():
        if abs(place - top) <= NEAREST * width:
            continue
        beside = wave[max(0, place - reach) : place + reach + 1]
        if -beside.min() < OWN_RINGING * wave[place]:
            found.append((place, float(wave[place] / peak)))
    return found


def _shoulders(wave: FloatArray, width: float) -> list[tuple[int, float]]:
    """Return bulges on the tail of the main pulse, or before it, that have no valley of their own."""
    top, reach = int(wave.argmax()), int(4 * width)
    peak, quiet = float(wave.max()), noise_level(wave)
    # smooth as much as the noise asks for: noise of the slope = quiet / sqrt(4 sqrt(pi) sigma^3)
    wanted = (6 * quiet * width / (SHOULDER * peak)) ** 2 / (4 * np.sqrt(np.pi))
    sigma = float(np.clip(wanted ** (1 / 3), width / 20, width / 8))
    least = max(SHOULDER * peak / width, 7 * quiet / np.sqrt(4 * np.sqrt(np.pi) * sigma**3))
    found = []
    for side in (1, -1):
        flank = wave[top : top + reach] if side == 1 else wave[max(0, top - reach) : top + 1][::-1]
        place = _shoulder(scipy.ndimage.gaussian_filter1d(flank, sigma, mode="nearest"), peak, least)
        if place is not None and place > NEAREST * width and flank[place] > SHOULDER_LEVEL * peak:
            found.append((top + side * place, float(flank[place] / peak)))
    return found


def _shoulder(flank: FloatArray, peak: float, least: float) -> int | None:
    """Return where a falling flank bulges: its slope relaxes and then steepens by ``least`` or more.

    At an end of the record there may be no flank.
    """
    if len(flank) < SLOPE:
        return None
    slope = np.gradient(flank)
    steepest = int(slope.argmin())
    dips = find_peaks(-slope[steepest:], prominence=least)
    for dip in (dips + steepest).tolist():
        relaxed = steepest + int(slope[steepest : dip + 1].argmax())
        if flank[relaxed] > SHOULDER_LEVEL * peak and slope[relaxed] > 0.5 * slope[dip]:
            return int(relaxed + dip) // 2
    return None
