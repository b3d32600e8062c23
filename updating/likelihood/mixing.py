"""What an idealisation that is off makes of the shapes of modes that are close: it mixes them.

A change of the mass that is known to a share only is known no better in what it couples. Two modes whose frequencies
are as close as it leaves them in doubt have shapes that nobody knows: each may hold a part of the other, measured or
not.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Setting
from updating.prediction.predict import Prediction
from updating.thresholds import COUPLED_SHARE, MOST_MIXED


def mixed(
    setting: Setting, now: Prediction, every: Prediction, level: FloatArray, fidelity: float
) -> FloatArray:
    """Return the change of the constants as each mode takes up its neighbour, (n_frf n_modes, n_modes) [-].

    By perturbation of the mass M (Fox and Kapoor 1968): m_ii moves ln f_i by -m_ii / 2 and m_ij adds to shape i of
    shape j the part m_ij / 2 over ln(f_j / f_i).

    Parameters
    ----------
    setting : Setting
        Test and model.
    now, every : Prediction
        The modes measured, and all that were predicted.
    level : (n_frf, n_modes) array
        What predicted constants are multiplied by [kg].
    fidelity : float
        How far the idealisation may be off, relative to the shift it makes [-].
    """
    test = setting.measured
    n_frf, n_modes = now.constants.shape
    gap = np.abs(np.log(every.frequency[None, :] / now.frequency[:, None]))
    gap = np.where(gap > 0, gap, np.inf)
    nearest = np.argmin(gap, axis=1)
    doubt = fidelity * np.abs(np.log(now.frequency / setting.nominal.frequency))
    part = np.minimum(COUPLED_SHARE * doubt / gap[np.arange(n_modes), nearest], MOST_MIXED)
    rows = setting.predictor.nominal_rows["w"][:, : len(now.vectors)]
    shapes, others = rows @ now.vectors, rows @ every.vectors[:, nearest]
    bare = test.hit[:, None] < 0
    both = others[test.seen] * shapes[test.hit] + shapes[test.seen] * others[test.hit]
    changed = np.where(bare, others[test.seen], both)
    columns = np.zeros((n_frf, n_modes, n_modes))
    columns[:, np.arange(n_modes), np.arange(n_modes)] = changed * part * level
    return columns.reshape(n_frf * n_modes, n_modes)
