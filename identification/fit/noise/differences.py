"""Differences from line to line: blind to what is smooth over the lines, they show noise whatever a model lacks."""

from __future__ import annotations

from math import comb

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, row_blocks, squared


def power_of_differences(residual: ComplexArray, order: int) -> FloatArray:
    """Return |differences|^2 along the lines, of white noise as large as its own, (n_frf, n_lines - order).

    Parameters
    ----------
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    order : int
        Order of the differences [-].
    """
    n_frf, n_lines = residual.shape
    power = np.empty((n_frf, n_lines - order))
    for rows in row_blocks(residual.shape):
        power[rows] = squared(np.diff(residual[rows], n=order, axis=1)) / comb(2 * order, order)
    return power
