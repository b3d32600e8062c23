"""Fewer lines for the same fit: averages over stretches of lines on which no pole is near."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.basis import Axis
from identification.fit.equations.normal_equations import Weights

_ENOUGH = 4000
_LARGEST = 64
_SHARE = 40.0
_NEAR = 40.0


@dataclass(frozen=True, eq=False)
class Lines:
    """What a fit needs of FRFs, on lines that need not be evenly spaced.

    Parameters
    ----------
    axis : Axis
        Where the lines lie, and what the FRFs are.
    values : (n_frf, n_lines) complex array
        FRF values [unit of the FRFs].
    """

    axis: Axis
    values: ComplexArray

    @classmethod
    def of(cls, frfs: FrfSet) -> Lines:
        """Return all lines of a set."""
        return cls(Axis.of(frfs), frfs.values)


def selected_lines(frfs: FrfSet, poles: ComplexArray, weights: Weights) -> tuple[Lines, Weights]:
    """Average lines far from every pole, weights adding up.

    All lines are kept within 40 lines of each pole and of s = 0; elsewhere a stretch is at most a fortieth of
    the distance in the Laplace plane long, so that a mode's flank bends over it by less than 1e-4 of itself.
    Under 4000 lines nothing is done.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    poles : (n_poles,) complex array
        Poles the fit is about [rad/s].
    weights : Weights
        Weight of every value.
    """
    n_lines = len(frfs.frequency)
    if n_lines < _ENOUGH:
        return Lines.of(frfs), weights
    start = _starts(frfs, poles)
    count = np.diff(np.append(start, n_lines))
    lines = np.add.reduceat(weights.lines, start, axis=1)
    values: ComplexArray = np.asarray(
        np.add.reduceat(frfs.values * weights.lines, start, axis=1) / lines, complex
    )
    laplace: ComplexArray = np.asarray(np.add.reduceat(frfs.laplace, start) / count, complex)
    return Lines(replace(Axis.of(frfs), laplace=laplace), values), Weights(weights.level, lines, weights.fade)


def _starts(frfs: FrfSet, poles: ComplexArray) -> IntArray:
    """Return the first line of every stretch, shape (n_stretches,)."""
    step = 2 * np.pi * frfs.df
    distance = np.full(len(frfs.frequency), np.inf)
    for pole in np.append(poles, frfs.decay):
        away = np.abs(frfs.laplace - pole) / step
        np.minimum(distance, np.where(away > _NEAR, away, 0.0), out=distance)
    longest = np.clip(distance / _SHARE, 1.0, _LARGEST)
    segment = np.arange(0, len(distance), _LARGEST)
    size = 2.0 ** np.floor(np.log2(np.minimum.reduceat(longest, segment)))
    own = np.repeat(size, np.diff(np.append(segment, len(distance)))).astype(np.int64)
    return np.flatnonzero((np.arange(len(distance)) % _LARGEST) % own == 0)
