"""The motion of the whole structure behind a column of measured FRFs."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray
from updating.frf_update.columns import Columns
from updating.frf_update.evaluation import Evaluation
from updating.models.response import answers, on_each_line

RIDGE = 1e-4
"""Share of the mean stiffness of the explanation under which a direction is left to the model [-]."""


def expand(at: Evaluation, ends: Columns, measured: ComplexArray) -> ComplexArray:
    """Expand measured receptances to the whole basis, for the {H^X}_j of paper B's Eq. 9.

    The equation needs the measured column at every degree of freedom, and a test gives it at a few. Of all
    motions that agree with the measurement the one is taken whose force residual Z x - f is least (in the
    coordinates of the basis, which is orthonormal in the nominal mass): where the test has no data the model
    is believed, and as little force as possible is invented.

    Parameters
    ----------
    at : Evaluation
        The model.
    ends : Columns
        The points of every FRF.
    measured : (n_frf, n_lines) complex array
        Measured receptances [m/N].

    Returns
    -------
    (n_lines, r, n_excitations) complex array
        Motion of the basis under each excitation of ``ends`` [m/N].
    """
    found = []
    everywhere = answers(at.matrices, np.eye(at.states.shape[1]), at.laplace)
    for excitation, rows in ends.groups:
        own = at.states[:, :, excitation]
        computed = on_each_line(at.rows[ends.response[rows]], own[:, :, None])[:, :, 0]
        missing = (measured[rows] / at.gain).T - computed
        lever = at.states[:, :, ends.response[rows]].transpose(0, 2, 1)
        back = lever.conj().transpose(0, 2, 1)
        gram = lever @ back
        size = np.einsum("lii->l", gram).real / len(rows)
        gram = gram + RIDGE * size[:, None, None] * np.eye(len(rows))
        force = back @ np.linalg.solve(gram, missing[:, :, None])
        found.append(own + (everywhere @ force)[:, :, 0])
    return np.stack(found, axis=-1)
