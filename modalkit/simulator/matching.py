"""Which mode of one rig is which of another, where effects shift, split or add modes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from identification.mac import mac
from identification.pairing import counterparts, unlikeness
from modalkit.simulator.bodies.complex_modes import ComplexModes


def match(wanted: ComplexModes, among: ComplexModes) -> IntArray:
    """Return for each wanted mode the most similar other one, each taken once.

    Parameters
    ----------
    wanted, among : ComplexModes
        At the same points; there are at least as many of the second as of the first.

    Returns
    -------
    (n_wanted,) array
        Indices into ``among``, by shape and frequency.
    """
    away = np.log(wanted.frequency)[:, None] - np.log(among.frequency)[None]
    return counterparts(unlikeness(mac(wanted.points, among.points), away))


def log_ratios(wanted: ComplexModes, among: ComplexModes) -> FloatArray:
    """Return ln of the matched frequencies over the wanted ones, shape (n_wanted,) [-]."""
    ratios: FloatArray = np.log(among.frequency[match(wanted, among)] / wanted.frequency)
    return ratios
