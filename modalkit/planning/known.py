"""What is known about a test that is planned or was made: the rig's setup, and how well each kind of datum is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.setup import Setup

FREQUENCY_SIGMA = 2e-4
"""Relative standard deviation of an identified frequency where no data tell [-]."""

DAMPING_SIGMA = 0.05
"""Relative standard deviation of an identified damping ratio where no data tell [-]."""

SHAPE_SIGMA = 0.02
"""Standard deviation of modal constants, relative to each mode's largest, where no data tell [-]."""


@dataclass(frozen=True, eq=False)
class KnownTest:
    """A test as the forecast takes it.

    Parameters
    ----------
    setup : Setup
        Specimen, points, band, noise and tolerances; ``setup.modes`` are the modes that the band holds.
    frequency, damping, shape : (n_modes,) arrays
        Relative standard deviations by the identification: of frequencies, of damping ratios, and of modal
        constants over their mode's largest [-].
    damping_known : bool
        Whether the model or a baseline says what damping to expect; otherwise damping tells nothing.
    shapes : bool
        Whether there are modal constants at all.
    absolute : bool
        Whether those carry absolute level; otherwise they are shapes, up to a factor per mode.
    without : tuple of str
        Effects that are not asked about.
    statement : tuple of str
        Where each figure comes from.
    left_out : tuple of str
        What the study says and the rig cannot do.
    """

    setup: Setup
    frequency: FloatArray
    damping: FloatArray
    shape: FloatArray
    damping_known: bool = True
    shapes: bool = True
    absolute: bool = True
    without: tuple[str, ...] = ()
    statement: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


def by_default(modes: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the standard deviations that are taken where no data tell.

    Parameters
    ----------
    modes : int
        Number of modes [-].

    Returns
    -------
    frequency, damping, shape : (modes,) arrays
        Relative standard deviations [-].
    """
    return np.full(modes, FREQUENCY_SIGMA), np.full(modes, DAMPING_SIGMA), np.full(modes, SHAPE_SIGMA)
