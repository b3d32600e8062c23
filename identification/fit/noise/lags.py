"""Whether FRFs can have a line shape: what they hold at the lags at which it leaves nothing.

A line shape is a factor on the impulse response, and it vanishes at some lags. What rings there in the transform of the
FRFs was not under that window, whichever modes they have and however these differ from FRF to FRF: a test that needs no
fit to hold. Modes that have died away by then, and errors of averages, are not informative.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.signal.windows import tukey

from acquisition.arrays import ComplexArray, FloatArray, squared
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.basis import Axis
from identification.fit.equations.refine import Fit
from identification.fit.equations.residues import synthesise

EDGE = 0.2
"""Part of the band over which FRFs are faded in and out, both ends together [-]: a step at its end rings over all lags.
Doubled: modes near the ends count less."""

LEAST = 0.01
"""Part of the power that modes without the shape must have at those lags, for the lags to be informative [-]: errors
of averages over 60 blocks have a tenth of that. Doubled: peaks a line wide give no more information."""


def contradicted(frfs: FrfSet, fit: Fit) -> bool:
    """Return whether FRFs ring at the lags at which their line shape leaves nothing.

    They do if their power there is nearer to what the modes of a fit would have without the shape than with it. FRFs
    count by the part of their power that the fit explains: noise rings at all lags.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, with the line shape that they may have.
    fit : Fit
        A fit to them, with it or without.
    """
    shape = frfs.line_shape
    if shape is None:
        return False
    axis = Axis.of(frfs)
    shaped, plain = (synthesise(a, fit.poles, fit.linear) for a in (axis, replace(axis, shape=None)))
    given, tiny = squared(frfs.values).sum(axis=1), np.finfo(float).tiny
    explained = np.minimum(squared(plain).sum(axis=1) / np.maximum(given, tiny), 1.0) ** 2 + tiny
    held, free, seen = (_share(values, shape.silent, explained) for values in (shaped, plain, frfs.values))
    return free > LEAST and seen > 0.5 * (held + free)


def _share(values: ComplexArray, lags: tuple[float, float], weight: FloatArray) -> float:
    """Return the part of the power of FRFs between two lags, the weighted mean over the FRFs [-]."""
    n_lines = values.shape[1]
    power = squared(np.fft.ifft(values * tukey(n_lines, EDGE), axis=1))
    lag = np.arange(n_lines) / n_lines
    part = power[:, (lag > lags[0]) & (lag < lags[1])].sum(axis=1)
    return float(np.average(part / np.maximum(power.sum(axis=1), np.finfo(float).tiny), weights=weight))
