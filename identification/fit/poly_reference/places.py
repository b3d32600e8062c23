"""Where FRFs of several references stand in the matrix of responses by references."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.arrangement import arrange, signs


@dataclass(frozen=True, eq=False)
class Sorted:
    """Where each FRF stands in the matrix of responses by references.

    Parameters
    ----------
    row, column : (n_frf,) int arrays
        Its place [-].
    sign : (n_frf,) array
        Product of the signs of its directions [-].
    shape : tuple of int
        Numbers of rows and columns.
    """

    row: IntArray
    column: IntArray
    sign: FloatArray
    shape: tuple[int, int]


def sorted_frfs(frfs: FrfSet) -> Sorted | None:
    """Return the places of the FRFs, or None if there is one reference or a place is taken twice."""
    plan = arrange(frfs)
    if len(plan.columns) < 2 or np.count_nonzero(plan.index >= 0) < len(frfs.values):
        return None
    row, column = np.empty(len(frfs.values), np.int64), np.empty(len(frfs.values), np.int64)
    rows, columns = np.nonzero(plan.index >= 0)
    row[plan.index[rows, columns]], column[plan.index[rows, columns]] = rows, columns
    if len(frfs.values) <= len(plan.rows) + len(plan.columns) - 1:
        return None
    return Sorted(row, column, signs(frfs), (len(plan.rows), len(plan.columns)))
