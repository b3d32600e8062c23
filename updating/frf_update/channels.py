"""FRFs that are unlike all others: a channel wired the wrong way round, scaled wrongly, or dead.

One such FRF among many pulls every parameter, and no parameter of a model can follow it. Beside the model that the
others have found it stands out by its level or its sign on all lines.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.frf_update.columns import columns
from updating.frf_update.evaluation import evaluate
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.test_data.measured_frfs import MeasuredFrfs

FEWEST = 4
"""Fewest FRFs of which one can be called odd, and one for so many may be [-]."""

LEVEL = 0.3
"""Difference of the logarithm of the level from the others' that no structure shows [-]."""

SCATTER = 5.0
"""The same in standard deviations of the others [-]."""

OPPOSITE = -0.5
"""Mean cosine of the phase to the model's under which an FRF points the wrong way, if the others agree [-]."""

AUDIBLE = 9.0
"""Power over noise of an informative line, of the measured or the computed FRF [-]."""


def odd(frfs: MeasuredFrfs, predictor: Predictor, state: State) -> dict[int, str]:
    """Return the FRFs that stand out beside a model that was fitted to all, and how.

    Parameters
    ----------
    frfs : MeasuredFrfs
        All FRFs.
    predictor : Predictor
        The specimen.
    state : State
        What was fitted.

    Returns
    -------
    dict of int to str
        Row of each and what is wrong with it; empty where none or too many are unlike the others.
    """
    count = len(frfs.values)
    if count < FEWEST:
        return {}
    model = evaluate(predictor, state, columns(frfs), frfs.laplace, order=frfs.order).receptance
    level, cosine = _compared(frfs, model)
    middle = np.nanmedian(level)
    away = np.abs(level - middle)
    spread = 1.4826 * float(np.nanmedian(away))
    found = {i: f"{np.exp(level[i] - middle):.3g} times the level" for i in _over(away, spread)}
    if np.nanmedian(cosine) > -OPPOSITE:
        found |= {int(i): "the opposite sign" for i in np.flatnonzero(cosine < OPPOSITE)}
    return found if len(found) <= count // FEWEST else {}


def _over(away: FloatArray, spread: float) -> Sequence[int]:
    return [int(i) for i in np.flatnonzero(away > max(LEVEL, SCATTER * spread))]


def _compared(frfs: MeasuredFrfs, model: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Return the median log level and the mean cosine of the phase of every FRF to the model's (n_frf,) [-]."""
    size, own = np.abs(frfs.values), np.abs(model)
    above_noise = np.maximum(size, own) ** 2 > AUDIBLE * frfs.variance
    enough = above_noise.sum(axis=1) >= max(5, above_noise.shape[1] // 20)
    tiny = 1e-30 * max(float(own.max()), 1e-300)
    ratio = np.where(above_noise, np.log(np.maximum(size, tiny) / np.maximum(own, tiny)), np.nan)
    turned = (frfs.values * model.conj()).real / np.maximum(size * own, tiny**2)
    level, cosine = np.full(len(size), np.nan), np.full(len(size), np.nan)
    level[enough] = np.nanmedian(ratio[enough], axis=1)
    cosine[enough] = np.nanmean(np.where(above_noise, turned, np.nan)[enough], axis=1)
    return level, cosine
