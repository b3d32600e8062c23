"""Data that are worse than thought, at a price: which channels of which modes, and which measuring channels.

What a test states of its noise holds for most of its data and not for all: a mode whose two neighbours overlap, a
sensor that is loose, a ratio of damping from three lines. So each *cell* (one kind of data of one mode, or all modal
constants of one measuring channel) may have a standard deviation a power of two larger than thought. Which cells, and
by how much, is found by the likelihood itself: the cell that gains the most is raised, and again, until none gains its
price. The marginal likelihood is the sum over the settings found on the way, the one where nothing is raised among
them: a lower bound of the sum over all settings, which it reaches where one setting stands out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.comparison import Comparison
from updating.thresholds import MOST_WORSE_CELLS, WORSE_CELL_PRIOR, WORSE_SCALES


@dataclass(frozen=True, eq=False)
class Cells:
    """Which data belong together.

    Parameters
    ----------
    of_mode, of_source : (n,) int arrays
        Cell of each datum by its kind and mode, and by its measuring channel; -1 is none.
    count : int
        Number of cells of both sorts.
    size : (count,) int array
        Number of data in each.
    """

    of_mode: IntArray
    of_source: IntArray
    count: int
    size: IntArray

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sum of (n,) values over each cell, (count,)."""
        total = np.bincount(self.of_mode, values, minlength=self.count)
        has = self.of_source >= 0
        return np.asarray(total + np.bincount(self.of_source[has], values[has], minlength=self.count))

    def members(self, cell: int) -> BoolArray:
        """Return which data (n,) are in a cell."""
        return np.asarray((self.of_mode == cell) | (self.of_source == cell))


def cells(comparison: Comparison, keep: BoolArray | None = None) -> Cells:
    """Return the cells of a comparison, of the data kept."""
    rows = slice(None) if keep is None else keep
    key = comparison.channel[rows] * (int(comparison.mode.max(initial=0)) + 1) + comparison.mode[rows]
    names, of_mode = np.unique(key, return_inverse=True)
    source = comparison.source[rows]
    known, rank = np.unique(source, return_inverse=True)
    of_source = np.where(source >= 0, rank + len(names), -1)
    count = len(names) + len(known)
    size = np.bincount(of_mode, minlength=count) + np.bincount(of_source[source >= 0], minlength=count)
    return Cells(np.asarray(of_mode), np.asarray(of_source), count, np.asarray(size))


@dataclass(frozen=True, eq=False)
class Worse:
    """What was found worse than thought.

    Parameters
    ----------
    factor : (n,) array
        How many times larger the standard deviation of each datum was taken; 1 is as thought [-].
    gain : float
        What allowing for it adds to the logarithm of the likelihood, its price paid [-].
    """

    factor: FloatArray
    gain: float


def worse_than_thought(
    residual: FloatArray, nuisance: FloatArray, variance: FloatArray, group: Cells
) -> Worse:
    """Find the cells that are worse than thought.

    Parameters
    ----------
    residual, variance : (n,) arrays
        Measured minus predicted, and the variance of the independent noise [-].
    nuisance : (n, p) array
        Change per standard deviation of each nuisance [-].
    group : Cells
        Which data belong together.
    """
    factor = np.ones(len(residual))
    gains = [0.0]
    scales = np.square(np.array(WORSE_SCALES))[:, None]
    price = np.log(WORSE_CELL_PRIOR / len(WORSE_SCALES))
    score = _score(residual, nuisance, variance)
    raised: set[int] = set()
    for _ in range(MOST_WORSE_CELLS):
        noise = variance * factor**2
        white = nuisance / np.sqrt(noise)[:, None]
        spread = np.linalg.inv(np.eye(nuisance.shape[1]) + white.T @ white)
        shift = spread @ (white.T @ (residual / np.sqrt(noise)))
        left = np.square(residual - nuisance @ shift) / noise
        free = 1.0 - np.einsum("ij,ij->i", white @ spread, white)
        # one mean freedom for all data of a cell: exact where it is one datum, enough to choose elsewhere
        square, freedom = group.sums(left), group.sums(free) / np.maximum(group.size, 1)
        grown = (scales - 1) * freedom
        expected = 0.5 * ((scales - 1) * square / (1 + grown) - group.size * np.log1p(grown)) + price
        expected[:, [*raised]] = -np.inf
        best, cell = np.unravel_index(int(np.argmax(expected)), expected.shape)
        if expected[best, cell] <= 0:
            break
        raised.add(int(cell))
        trial = np.where(group.members(int(cell)), factor * WORSE_SCALES[best], factor)
        reached = _score(residual, nuisance, variance * trial**2)
        gain = gains[-1] + reached - score + price
        if gain <= gains[-1]:
            break
        factor, score = trial, reached
        gains.append(float(gain))
    top = max(gains)
    return Worse(factor, top + float(np.log(np.sum(np.exp(np.array(gains) - top)))))


def _score(residual: FloatArray, nuisance: FloatArray, variance: FloatArray) -> float:
    """Return the logarithm of the Gaussian marginal likelihood, but for a constant."""
    white, r = nuisance / np.sqrt(variance)[:, None], residual / np.sqrt(variance)
    lower = np.linalg.cholesky(np.eye(nuisance.shape[1]) + white.T @ white)
    load = np.linalg.solve(lower, white.T @ r)
    chi2 = float(r @ r - load @ load)
    return -0.5 * (chi2 + 2 * float(np.log(np.diag(lower)).sum()) + float(np.log(variance).sum()))
