"""What mounting the structure anew would do to its FRFs: every resonance moves a little.

The scatter of the frequencies from one mounting to the next, which the study states, belongs to the uncertainty of
whatever is updated, by FRFs as by frequencies. It is no noise: it is alike on all lines and at all points.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from updating.frf_update.columns import Columns
from updating.frf_update.evaluation import Evaluation

BEYOND = 1.2
"""Modes up to so many times the highest line move the FRFs [-]."""


def resonances(at: Evaluation) -> IntArray:
    """Return the numbers of the elastic modes that count, in order of frequency."""
    values = at.matrices.undamped[0]
    top = (BEYOND * np.abs(at.laplace.imag).max()) ** 2
    elastic = np.arange(len(values)) >= at.matrices.rigid
    return np.flatnonzero(elastic & (values > 0) & (values < top))


def shifted(at: Evaluation, ends: Columns, shift: FloatArray) -> ComplexArray:
    """Return what moved resonances add to the model's receptances, each mode by itself.

    Parameters
    ----------
    at : Evaluation
        The model.
    ends : Columns
        The points of every FRF.
    shift : (n_modes,) array
        Relative change of the frequency of each of :func:`resonances` [-].

    Returns
    -------
    (n_modes, n_frf, n_lines) complex array
        Differences of the receptances [m/N].
    """
    values, vectors = at.matrices.undamped
    modes = resonances(at)
    stiffness, shapes = values[modes], vectors[:, modes]
    viscous = np.einsum("ir,ij,jr->r", shapes, at.matrices.viscous, shapes)
    structural = np.einsum("ir,ij,jr->r", shapes, at.matrices.structural, shapes)
    s = at.laplace
    before = s**2 + viscous[:, None] * s + (stiffness + 1j * structural)[:, None]
    more = (stiffness * ((1 + shift) ** 2 - 1))[:, None]
    change = 1 / (before + more) - 1 / before
    rows = at.rows @ shapes
    constants = rows[ends.response] * rows[ends.excitation]
    return np.asarray(at.gain * constants.T[:, :, None] * change[:, None, :])
