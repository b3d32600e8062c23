"""Offset and slow drift of a force record, as its samples without force show them."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, FloatArray

ROUNDS = 5
"""Times the samples without force are sought and the drift is fitted to them; the last two agree [-]."""

APART = 4.0
"""Standard deviations from the drift beyond which a sample has force [-]."""

STRETCHES, FAINT = 8, 1e-3
"""Stretches of a record that have a noise of their own, since a window makes it fade; one without noise, as steps of a
converter leave it, counts as if it had a thousandth of the strongest [-]."""

SURE = 30.0
"""Variance ratio from which a drift is taken off: noise alone reaches it in one record of a million [-]."""


def without_drift(force: FloatArray, *, fade: float = 0.0) -> FloatArray:
    """Return force records without their offset, and without a drift where it exceeds what noise makes.

    Parameters
    ----------
    force : (n_hits, n_samples) array
        Records [any].
    fade : float
        Decay of an exponential window in them [1/sample]: an offset may have been there before the window, and
        falls with it, or have come after it.

    Notes
    -----
    The drift is a straight line, and with a window another one that falls with it. It is fitted to the samples that
    lie near it by least squares, weighted by the noise about each, again and again as these are known better.
    """
    centred = np.asarray(force - np.median(force, axis=-1, keepdims=True), dtype=np.float64)
    place = np.linspace(-1.0, 1.0, centred.shape[-1])
    window = np.exp(-fade * np.arange(centred.shape[-1]))
    terms = [np.ones_like(place), place] + ([window, window * place] if fade else [])
    for row in np.flatnonzero(_uneven(centred)):
        centred[row] = _level(centred[row], np.stack(terms, axis=1))
    return centred


def _uneven(centred: FloatArray) -> BoolArray:
    """Return which records have stretches whose medians differ by more than noise makes them, (n_hits,)."""
    length = centred.shape[-1] // STRETCHES
    if length < 4:
        return np.zeros(len(centred), dtype=np.bool_)
    parts = centred[:, : STRETCHES * length].reshape(len(centred), STRETCHES, length)
    middle = np.median(parts, axis=-1)
    noise = 1.4826 * np.median(np.abs(parts - middle[..., None]), axis=-1)
    off = np.abs(middle - np.median(middle, axis=-1, keepdims=True))
    return np.asarray((off * np.sqrt(length) > 3.0 * noise).sum(axis=-1) > 1)


def _level(wave: FloatArray, terms: FloatArray) -> FloatArray:
    """Return a centred record without the drift that it surely has."""
    if not np.isfinite(wave).all():
        return wave
    weight, drift = np.ones(len(wave)), np.zeros(len(wave))
    for _ in range(ROUNDS):
        some = terms * weight[:, None]
        drift = terms @ np.linalg.lstsq(some.T @ terms, some.T @ wave, rcond=None)[0]
        weight = _weight(wave - drift)
        if 2 * np.count_nonzero(weight) < len(wave):
            return wave
    return wave - drift if _sure(wave, drift, weight, terms.shape[1]) else wave


def _weight(left: FloatArray) -> FloatArray:
    """Return the inverse variance of the noise about each sample, 0 for samples with force (n_samples,)."""
    size = np.abs(left)
    parts = np.array_split(size, STRETCHES)
    noise = 1.4826 * np.array([np.median(part) for part in parts])
    if not noise.any():
        return np.asarray(size == 0, dtype=np.float64)
    spread = np.repeat(np.maximum(noise, FAINT * noise.max()), [len(part) for part in parts])
    return np.asarray((size <= APART * spread) / spread**2, dtype=np.float64)


def _sure(wave: FloatArray, drift: FloatArray, weight: FloatArray, count: int) -> bool:
    """Return whether a drift leaves so much less of the samples without force that noise cannot be the reason."""
    constant = float(weight @ (wave - weight @ wave / weight.sum()) ** 2)
    left = float(weight @ (wave - drift) ** 2)
    return bool((constant - left) / (count - 1) > SURE * left / (np.count_nonzero(weight) - count))
