"""Which mode of one rig is which of another, where effects shift, split or add modes."""

from __future__ import annotations

import numpy as np
import scipy.optimize

from acquisition.arrays import FloatArray, IntArray
from modalkit.simulator.bodies.complex_modes import ComplexModes

_FAR = 0.5


def match(wanted: ComplexModes, among: ComplexModes) -> IntArray:
    """Return for each wanted mode the most similar other one, each taken once.

    Parameters
    ----------
    wanted, among : ComplexModes
        At the same points; there are at least as many of the second as of the first.

    Returns
    -------
    (n_wanted,) array
        Indices into ``among``: the assignment that is best in MAC less the distance in ln f, a factor of
        e^2 in frequency counting as much as a MAC of zero [-].
    """
    a, b = wanted.points, among.points
    products = np.abs(a.conj().T @ b) ** 2
    mac = products / np.outer(np.sum(np.abs(a) ** 2, axis=0), np.sum(np.abs(b) ** 2, axis=0))
    away = np.abs(np.log(wanted.frequency)[:, None] - np.log(among.frequency)[None])
    _, chosen = scipy.optimize.linear_sum_assignment(_FAR * away - mac)
    return np.asarray(chosen)


def log_ratios(wanted: ComplexModes, among: ComplexModes) -> FloatArray:
    """Return ln of the matched frequencies over the wanted ones, shape (n_wanted,) [-]."""
    ratios: FloatArray = np.log(among.frequency[match(wanted, among)] / wanted.frequency)
    return ratios
