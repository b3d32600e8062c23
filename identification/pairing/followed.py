"""Modes known again where each has its counterpart: those of one structure in two states, or in two models of it.

:func:`identification.pair` is for test and model, where a mode may have no partner at all.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import FloatArray, IntArray


def unlikeness(
    alike: FloatArray, away: FloatArray, *, weight: float = 0.5, farthest: float = 3.0
) -> FloatArray:
    """Return what it costs to take one mode for another, shape (n, m) [-].

    Parameters
    ----------
    alike : (n, m) array
        Squared correlation of their shapes; nan, of a mode that has lost its mass, is none [-].
    away : (n, m) array
        Logarithm of the ratio of their frequencies, nan where one has none [-].
    weight : float
        How much a frequency ratio of e counts against a correlation of zero [-].
    farthest : float
        Logarithm from which on a frequency lies no farther [-].
    """
    distance = np.abs(away)
    distance = np.where(distance < farthest, distance, farthest)  # nan is not below it
    return np.asarray(1 - np.where(np.isnan(alike), 0.0, alike) + weight * distance)


def counterparts(cost: FloatArray) -> IntArray:
    """Return the counterpart of each mode in the cheapest assignment of all at once, (n,).

    Parameters
    ----------
    cost : (n, m) array
        What it costs to take one for the other, as of :func:`unlikeness`, or ``-alike``; m is n or more [-].
    """
    return np.asarray(linear_sum_assignment(cost)[1])
