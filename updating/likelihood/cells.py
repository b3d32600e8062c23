"""Which data belong together: one kind of data of one mode, or all modal constants of one measuring channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.comparison import Comparison


@dataclass(frozen=True, eq=False)
class Cells:
    """Which data belong together.

    Parameters
    ----------
    of_mode, of_source : (n,) int arrays
        Cell of each datum by its kind and mode, and by its measuring channel; -1 is none.
    size : (count,) int array
        Number of data in each cell.
    """

    of_mode: IntArray
    of_source: IntArray
    size: IntArray

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sum of (n,) values over each cell, (count,)."""
        total = np.bincount(self.of_mode, values, minlength=len(self.size))
        has = self.of_source >= 0
        return np.asarray(total + np.bincount(self.of_source[has], values[has], minlength=len(self.size)))

    def members(self, cell: int) -> BoolArray:
        """Return which data (n,) are in a cell."""
        return np.asarray((self.of_mode == cell) | (self.of_source == cell))


def cells(comparison: Comparison) -> Cells:
    """Return the cells of a comparison."""
    key = comparison.channel * (int(comparison.mode.max(initial=0)) + 2) + comparison.mode + 1
    names, of_mode = np.unique(key, return_inverse=True)
    known, rank = np.unique(comparison.source, return_inverse=True)
    has = comparison.source >= 0
    of_source = np.where(has, rank + len(names), -1)
    count = len(names) + len(known)
    size = np.bincount(of_mode, minlength=count) + np.bincount(of_source[has], minlength=count)
    return Cells(np.asarray(of_mode), np.asarray(of_source), np.asarray(size))
