"""Lines of noise alone, detected in FRFs without coherence or hits: noise rings before the force as it does after it.

The transform of a stretch of FRFs to lags has what a structure does at lag zero and behind it, also where lines are
averaged under a window or smoothed: their line shapes are lag windows. Noise has as much at negative lags as at
positive ones. Sizes are left out, phases alone are transformed: a peak of a few lines counts as no more than these
lines, and noise over a force of next to nothing, whose values are of any size, as no more than other noise.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import hann

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, squared

STRETCH = 64
"""Lines of a stretch. Doubled, the lines at which noise begins are located half as sharply [-]."""

STEP = 8
"""Lines from one stretch to the next. Doubled, less work and ends that are located half as sharply [-]."""

NEAR = 3
"""Lags about zero without information: what is smooth over a stretch is there, on both sides [lines of a stretch]."""

NOISE = 0.2
"""Part of the power of a stretch on that side of lag zero which has less, above which more than half is noise [-].
White noise has 0.39, smoothed noise 0.32; FRFs have less than 0.1, with peaks a tenth of a line wide each 100 lines
0.14. Doubled: no noise is found; halved: modes far narrower than a line pass for noise."""

SHOWN = 0.15
"""The same of one FRF, above which it shows no mode [-]. Smoothed noise, whose share scatters most, has less in one FRF
of ten thousand. Doubled: noise alone shows modes; halved: modes that few FRFs show pass for noise."""

SEEN = 0.1
"""Part of the FRFs, and one at least, in which a mode shows: others are at its nodes, or on parts that rest [-].
Doubled: modes of a tenth of a structure pass for noise."""


def noise_lines(values: ComplexArray) -> BoolArray:
    """Return which lines hold noise alone, in all FRFs but less than a tenth of them, (n_lines,).

    Parameters
    ----------
    values : (n_frf, n_lines) complex array
        FRFs, without a line at zero [any unit].
    """
    n_lines = values.shape[1]
    noise = np.zeros(n_lines, dtype=bool)
    starts = np.arange(n_lines - STRETCH, -1, -STEP)[::-1]
    if len(starts) < 2:
        return noise
    share = np.array([_poorer_side(values[:, a : a + STRETCH]) for a in starts])
    share = uniform_filter1d(share, STRETCH // STEP, axis=0, mode="nearest")
    least = np.quantile(share, SEEN, axis=1, method="lower")
    for a in starts[(share.mean(axis=1) > NOISE) & (least > SHOWN)]:
        noise[a : a + STRETCH] = True
    noise[: starts[0]] = noise[starts[0]]
    return noise


def _poorer_side(values: ComplexArray) -> FloatArray:
    """Return the part of the power of phases on the side of lag zero that has less, (n_frf,); half for zeros [-]."""
    size = np.maximum(np.abs(values), np.finfo(float).tiny)
    power: FloatArray = squared(np.fft.ifft(values / size * hann(STRETCH, sym=False), axis=1))
    sides = (power[:, NEAR : STRETCH // 2], power[:, STRETCH // 2 + 1 : 1 - NEAR])
    poorer, whole = np.minimum(sides[0].sum(axis=1), sides[1].sum(axis=1)), power.sum(axis=1)
    return np.where(whole > 0, poorer / np.maximum(whole, np.finfo(float).tiny), 0.5)
