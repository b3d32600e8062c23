"""Modes at lines that hold nothing of the structure: without coherence, or where the anti-alias filter falls."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.frfs.frf import FrfSet
from acquisition.quantities import hertz
from identification.band.informed import LOST, PASSED, best_coherence

FEWEST = 64
"""Fewest lines by whose number a whole transform is recognised; doubled, that of a short record is not [-]."""


def uninformed_modes(frfs: FrfSet, frequency: FloatArray) -> tuple[str, ...]:
    """Return what to say of modes that lie where FRFs carry no information of the structure.

    Parameters
    ----------
    frfs : FrfSet
        All lines of the FRFs, not only those of a band.
    frequency : (n_modes,) array
        Frequencies found [Hz].
    """
    coherent, notes = best_coherence(frfs), []
    if coherent is not None:
        lost = frequency[np.interp(frequency, frfs.frequency, coherent) < LOST]
        if len(lost):
            notes.append(
                f"mode(s) at {_named(lost)} lie where no FRF has a coherence over {LOST:g}: the force is too weak "
                "there, and they may be noise; leave them out with drop, or end the band below them"
            )
    filtered = frequency[frequency > _passed(frfs)]
    if len(filtered):
        notes.append(
            f"mode(s) at {_named(filtered)} lie above {hertz(_passed(frfs))} (sampling rate / {PASSED:g}), where the "
            "anti-aliasing filter falls off: an alias from beyond half the sampling rate may look like a mode; sample "
            "faster, or leave them out with drop"
        )
    return tuple(notes)


def _named(frequency: FloatArray) -> str:
    return ", ".join(hertz(f) for f in frequency)


def _passed(frfs: FrfSet) -> float:
    """Return up to where the filter passes, infinite where the rate is unknown [Hz].

    Lines from 0, one more than a power of two, are all that a transform gives: they end at half the rate.
    """
    last, count = float(frfs.frequency[-1]), len(frfs.frequency) - 1
    if frfs.record is not None and frfs.record.rate is not None:
        return frfs.record.rate / PASSED
    whole = frfs.frequency[0] < 0.5 * frfs.df and count >= FEWEST and count & (count - 1) == 0
    return 2 * last / PASSED if whole else np.inf
