"""Hits whose response the other hits at the same point do not explain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.fft

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.hits.hammer import Hits

OUTLIER = 0.05  # of the response's energy that the other hits do not explain
RATIO = 9.0  # times what the other hits leave of each other


def odd_responses(hits: Hits, good: Sequence[int], band: float) -> dict[int, float]:
    """Return which of the good hits stand out, and the part of their response left unexplained [-].

    The hit that the others explain worst is compared with how well these others explain each other without
    it, so that a bad hit does not spoil its own yardstick; it is set aside, and the next one compared.

    Parameters
    ----------
    hits : Hits
        Hits at one point.
    good : sequence of int
        Which hits are compared; fewer than three cannot be compared.
    band : float
        Upper end of the lines used, relative to the sampling rate [-].
    """
    odd: dict[int, float] = {}
    left = list(good)
    while len(left) > 2:
        misfit = unexplained(hits, left, band)
        worst, value = left[int(misfit.argmax())], float(misfit.max())
        rest = [i for i in left if i != worst]
        if value <= OUTLIER or value <= RATIO * float(np.median(unexplained(hits, rest, band))):
            break
        odd[worst] = value
        left = rest
    return odd


def unexplained(hits: Hits, good: Sequence[int], band: float) -> FloatArray:
    """Return what H1 over the other hits leaves of each response's energy, shape (len(good),) [-].

    Parameters
    ----------
    hits : Hits
        Hits at one point.
    good : sequence of int
        Which hits are compared.
    band : float
        Upper end of the lines used, relative to the sampling rate [-].
    """
    force, motion = _spectra(hits, good, band)
    cross, power = motion * force.conj()[:, None], np.abs(force) ** 2
    rest = np.maximum(power.sum(axis=0) - power, np.finfo(float).tiny)
    predicted = (cross.sum(axis=0) - cross) / rest[:, None] * force[:, None]
    energy = np.maximum((np.abs(motion) ** 2).sum(axis=-1), np.finfo(float).tiny)
    left = (np.abs(motion - predicted) ** 2).sum(axis=-1) / energy
    return np.asarray(left.mean(axis=-1), dtype=np.float64)


def agreement(hits: Hits, good: Sequence[int], band: float) -> float:
    """Return the mean coherence over hits at a point, of the responses that live [-].

    Parameters
    ----------
    hits : Hits
        Hits at one point.
    good : sequence of int
        Which hits are compared; two at least.
    band : float
        Upper end of the lines used, relative to the sampling rate [-].
    """
    force, motion = _spectra(hits, good, band)
    cross = np.abs((motion * force.conj()[:, None]).sum(axis=0)) ** 2
    power = (np.abs(motion) ** 2).sum(axis=0) * (np.abs(force) ** 2).sum(axis=0)
    alive = np.ptp(hits.motion[list(good)], axis=-1).min(axis=0) > 0
    if not alive.any():
        return 1.0
    return float(np.mean(cross[alive] / np.maximum(power[alive], np.finfo(float).tiny)))


def _spectra(hits: Hits, good: Sequence[int], band: float) -> tuple[ComplexArray, ComplexArray]:
    """Return the spectra of force (n, n_lines) and motion (n, n_responses, n_lines) of some hits up to a band."""
    lines = slice(1, max(3, int(band * hits.force.shape[-1])))
    force = scipy.fft.rfft(hits.force[list(good)], axis=-1)[:, lines]
    motion = scipy.fft.rfft(hits.motion[list(good)], axis=-1)[..., lines]
    return force, motion
