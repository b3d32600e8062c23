"""A drift over the test, found before any pole is.

From one fit to the next shifts are found where the peaks of all FRFs overlap (:mod:`identification.fit.drift`). Where
the sharp ones do not, one mode is a row of peaks, which pass for as many modes, or is lost. What all have in common
then shows in the spectra alone: over the logarithm of frequency a common factor is a common distance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import uniform_filter1d

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.fit.drift import LARGEST, measuring_order
from identification.fit.equations import basis
from identification.fit.equations.residues import fit_residues, synthesise

FEWEST = 4
"""Sets of FRFs under which no course is sought [-]: two in each half. Doubled: small tests that drift show a row of
modes for each."""

ABOUT = 0.1
"""Part of its frequency about a line whose mean its magnitude is taken over [-]: some widths of a peak, and less than
modes are apart. Doubled: a strong mode hides its neighbours."""

CLEARER = 1.1
"""By how much peaks that are brought together must rise in the mean square [-]. Noise gives some hundredths. Doubled:
drifts of a few widths go unnoticed."""

BENT = 0.3
"""How far the course may leave the line, over the rate [-]. Doubled: the peak of another mode may be taken for it."""

MOST_ROWS = 64
"""Sets of FRFs that are compared for the rate; of more, neighbours are averaged. Doubled: twice the memory."""

FINEST = 1e-4
"""Least step over the logarithm of frequency [-]: a tenth of the width of sharp peaks. Doubled: half the work."""


def course_of(frfs: FrfSet) -> FloatArray | None:
    """Return by what the frequencies of each FRF lie beside those in the middle of the test, relative, (n_frf,) [-].

    None where no line over measuring order brings peaks together, or the two halves of the test do not differ.
    """
    order = measuring_order(frfs)
    count = int(order.max()) + 1
    if count < FEWEST:
        return None
    step = max(frfs.df / float(frfs.frequency[-1]), FINEST)
    peaks = _peaks(frfs, step)
    place = np.linspace(-0.5, 0.5, count)
    halves = peaks[: count // 2].sum(axis=0), peaks[-(count // 2) :].sum(axis=0)
    if _lag(*halves, round(LARGEST / step)) == 0:
        return None
    most = round(2 * LARGEST / step)
    rates = np.arange(-most, most + 1)
    neighbours = np.array_split(peaks, min(count, MOST_ROWS))
    clarity = _clarities(np.array([rows.mean(axis=0) for rows in neighbours]), rates)
    best = int(clarity.argmax())
    if clarity[best] < CLEARER * clarity[most]:
        return None
    lags = np.rint(rates[best] * place).astype(np.int64)
    together = _moved(peaks, lags).mean(axis=0)
    reach = round(BENT * abs(int(rates[best]))) + 1
    lags += np.array([_lag(together, row, reach) for row in _moved(peaks, lags)])
    shift = np.expm1(step * (lags - lags.mean()))
    return np.asarray(np.clip(shift, -LARGEST, LARGEST)[order])


def _peaks(frfs: FrfSet, step: float) -> FloatArray:
    """Return by how much each set of FRFs exceeds its mean about each line, over the logarithm of frequency.

    Returns
    -------
    (n_groups, n) array
        At the distance ``step`` [-].
    """
    order, log = measuring_order(frfs), np.log(frfs.frequency)
    power = np.abs(frfs.values) ** 2
    mean = np.zeros((int(order.max()) + 1, len(log)))
    np.add.at(mean, order, power / np.maximum(power.mean(axis=1, keepdims=True), np.finfo(float).tiny))
    grid = np.arange(log[0], log[-1], step)
    size = np.array([np.interp(grid, log, row) for row in np.sqrt(mean)])
    about = uniform_filter1d(size, 2 * round(ABOUT / 2 / step) + 1, axis=1, mode="nearest")
    return np.asarray(np.maximum(size / np.maximum(about, np.finfo(float).tiny) - 1.0, 0.0))


def _moved(peaks: FloatArray, lags: FloatArray) -> FloatArray:
    """Return rows as they are so many steps further on, (n_groups, n)."""
    at = np.arange(peaks.shape[1])[None, :] + lags.astype(np.int64)[:, None]
    return np.asarray(np.take_along_axis(peaks, np.clip(at, 0, peaks.shape[1] - 1), axis=1))


def _clarities(peaks: FloatArray, rates: IntArray) -> FloatArray:
    """Return the square of the sum of rows, added up, once they are moved along a line, for each of its rates [-].

    It is what all pairs of rows have in common at their distance on the line: one autocorrelation over both axes.
    """
    count, length = len(peaks), peaks.shape[1] + int(np.abs(rates).max())
    spectrum = np.fft.fft(np.fft.rfft(peaks, length, axis=1), 2 * count, axis=0)
    alike = np.fft.irfft(np.fft.ifft(np.abs(spectrum) ** 2, axis=0)[:count], length, axis=1)
    apart = np.arange(1, count)
    lags = np.rint(rates[:, None] * apart / (count - 1)).astype(np.int64)
    return np.asarray(alike[0, 0] + 2.0 * alike[apart, lags].sum(axis=1))


def _lag(first: FloatArray, second: FloatArray, reach: int) -> int:
    """Return by how many steps, ``reach`` at the most, the second row lies further on."""
    length = 2 * len(first)
    product = np.fft.rfft(first, length).conj() * np.fft.rfft(second, length)
    return int(np.roll(np.fft.irfft(product, length), reach)[: 2 * reach + 1].argmax()) - reach


def resampled(frfs: FrfSet, course: FloatArray) -> FrfSet:
    """Return FRFs over the frequencies that they would have in the middle of the test: good for a first estimate."""
    values = np.array(frfs.values)
    low, high = float(frfs.frequency[0]), float(frfs.frequency[-1])
    for shift in np.unique(course):
        rows = np.flatnonzero(course == shift)
        at = np.clip(frfs.frequency * (1.0 + shift), low, high)
        values[rows] = CubicSpline(frfs.frequency, frfs.values[rows], axis=1)(at)
    return replace(frfs, values=values)


def without_course(frfs: FrfSet, poles: ComplexArray, course: FloatArray, powers: tuple[int, ...]) -> FrfSet:
    """Return FRFs as they would be at common poles, each fitted by these where its course has them.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs as measured.
    poles : (n_modes,) complex array
        Poles in the middle of the test [rad/s].
    course : (n_frf,) array
        As of :func:`course_of` [-].
    powers : tuple of int
        Of the residual terms [-].
    """
    values, axis = np.array(frfs.values), basis.Axis.of(frfs)
    for shift in np.unique(course):
        rows = np.flatnonzero(course == shift)
        linear = fit_residues(frfs.select(rows), poles * (1.0 + shift), powers=powers)
        values[rows] += synthesise(axis, poles, linear) - synthesise(axis, poles * (1.0 + shift), linear)
    return replace(frfs, values=values)
