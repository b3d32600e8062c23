"""When the hits of a test were given."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.hits.checks.pulse import pulse_width, upright

_WIDTHS = 4.0
"""Pulse widths to either side of the peak over which a pulse is examined [-]: a pulse and most of its ringing in a
filter. Over twice as many the noise of the force moves the place three times as much."""


def impulse_places(force: FloatArray) -> FloatArray:
    """Return where in their records the hits are, the centroids of their impulses, shape (n_hits,) [samples].

    Of the force, not of its power: that is the time by which the pulse, with the filter that it passed, delays a
    response far slower than itself. What lies far from the pulse is noise, and does not count: a long record's
    noise would draw the place to its middle.

    Parameters
    ----------
    force : (n_hits, n_samples) array
        Records of the force [any].
    """
    return np.array([_place(wave) for wave in upright(np.asarray(force, dtype=np.float64))])


def _place(wave: FloatArray) -> float:
    top = int(wave.argmax())
    reach = int(np.ceil(_WIDTHS * max(pulse_width(wave, 1.0), 2.0)))
    first = max(0, top - reach)
    near = wave[first : top + reach + 1]
    impulse = float(near.sum())
    place = float(near @ np.arange(len(near))) / impulse if impulse > 0.5 * wave[top] else np.inf
    return first + place if 0.0 <= place < len(near) else float(top)
