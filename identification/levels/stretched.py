"""Averages over hits of different levels whose frequency axes are stretched by what the level moves.

A mode that follows the force is at another frequency in every hit, and an average shows it as several. No single hit
does. So hits are laid over each other: the slope by which each stretch of the axis has to be stretched is that at which
the average over the hits is largest, where peaks and phases agree. What comes out is good enough to look for modes in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from acquisition import Windows
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.levels.hits import Judged, mean_level
from identification.levels.slopes import band_of, known_hits, rows_of
from identification.model import ModalModel

LARGEST, STEPS = 0.15, 121
"""Largest change of frequency over the mean level that is searched, and the number of slopes tried [-]: steps of a
quarter of a per cent move a peak by a per mille between a soft and a hard hit. Twice as many take twice the time."""

WINDOW = 0.08
"""Stretch of the axis over which one slope is taken for all modes, one standard deviation of ln f [-]. Doubled, modes
that lie 10 % apart share a slope; halved, noise between the modes has an influence."""

POINTS = 4000
"""Number of points of the logarithmic axis [-]: some hundred for each octave of five decades."""


@dataclass(frozen=True, eq=False)
class Stretched:
    """FRFs averaged along stretched axes.

    Parameters
    ----------
    frfs : FrfSet
        The averages, without their errors.
    slope : (n_lines,) array
        d ln f / dF by which their axes were stretched [1/N].
    """

    frfs: FrfSet
    slope: FloatArray

    def slopes_at(self, frequency: FloatArray) -> FloatArray:
        """Return the slopes at frequencies [1/N]."""
        return np.asarray(np.interp(frequency, self.frfs.frequency, self.slope))


@dataclass(frozen=True, eq=False)
class _Singles:
    """FRFs of single hits.

    Parameters
    ----------
    values : (n, n_lines) complex array
        FRFs, in the unit of the set's.
    row : (n,) int array
        Which FRF of a set each is one of.
    beyond : (n,) array
        Level of the hit less the common one, over that [-].
    weight : (n,) array
        Power of the hit [N^2].
    """

    values: ComplexArray
    row: IntArray
    beyond: FloatArray
    weight: FloatArray

    def averages(self, frequency: FloatArray, slope: FloatArray | float, rows: int) -> ComplexArray:
        """Return the averages along axes that are stretched by a slope per common level, (rows, n_lines)."""
        step = (frequency[-1] - frequency[0]) / (len(frequency) - 1)
        at = (frequency * np.exp(slope * self.beyond[:, None]) - frequency[0]) / step
        below = np.clip(np.floor(at).astype(np.int64), 0, len(frequency) - 2)
        part = np.clip(at - below, 0.0, 1.0)
        own = np.arange(len(self.values))[:, None]
        values = self.values[own, below] * (1 - part) + self.values[own, below + 1] * part
        member = np.where(self.row == np.arange(rows)[:, None], self.weight, 0.0)
        return np.asarray(member / np.maximum(member.sum(axis=1, keepdims=True), 1e-300) @ values)


def stretched_averages(
    model: ModalModel, tests: Sequence[Judged], *, windows: Windows | None = None
) -> Stretched:
    """Return the FRFs of a model's band, averaged over hits whose axes are stretched to a common level.

    Parameters
    ----------
    model : ModalModel
        Identified from plain averages over these hits, some of which show the level.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    windows : Windows, optional
        As when the FRFs were estimated.
    """
    data = model.frfs
    level, singles = _singles(model, tests, windows)
    slope = _sharpest(singles, data.frequency, len(data.values))
    values, known = data.values.copy(), np.unique(singles.row)
    values[known] = singles.averages(data.frequency, slope, len(values))[known]
    bare = replace(
        data,
        values=values,
        coherence=None,
        variance=None,
        averages=None,
        scatter=None,
        record=None,
        window="none",
    )
    return Stretched(bare, slope / level)


def _singles(model: ModalModel, tests: Sequence[Judged], windows: Windows | None) -> tuple[float, _Singles]:
    """Return the common level [N], and the FRFs of the single hits that the model has."""
    rows = rows_of(model)
    band = band_of(model)
    entries = known_hits(tests, rows)
    level = mean_level(entries)
    found = [
        (values, rows[pair], own / level - 1, own**2)
        for entry in entries
        for own, frfs in zip(entry.levels, entry.single_frfs(windows=windows, band=band), strict=True)
        for values, pair in zip(frfs.values, zip(frfs.responses, frfs.references, strict=True), strict=True)
        if pair in rows
    ]
    values, row, beyond, weight = zip(*found, strict=True)
    return level, _Singles(np.array(values), np.array(row), np.array(beyond), np.array(weight))


def _sharpest(singles: _Singles, frequency: FloatArray, rows: int) -> FloatArray:
    """Return the slope at each line, per common level, at which averages are largest about it, (n_lines,) [-]."""
    slopes = np.linspace(-LARGEST, LARGEST, STEPS)
    axis = np.log(frequency)
    even = np.linspace(axis[0], axis[-1], POINTS)
    width = WINDOW / (even[1] - even[0])
    # a mode's peak has the same height whatever its frequency, so every one counts alike on a logarithmic axis
    power = [np.sum(np.abs(singles.averages(frequency, s, rows)) ** 2, axis=0) for s in slopes]
    about = [ndimage.gaussian_filter1d(np.interp(even, axis, p), width) for p in power]
    best = slopes[np.argmax(about, axis=0)]
    return np.asarray(np.interp(axis, even, ndimage.gaussian_filter1d(best, width / 2)))
