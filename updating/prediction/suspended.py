"""Measured modes in which a free structure moves as a whole on what it hangs on, and which the model has at zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from acquisition.quantities import hertz
from updating.models.state import NOMINAL
from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured

AS_A_WHOLE = 0.9
"""Share of a shape that is a motion of the whole body, squared, from which the mode counts as one on the suspension
[-]. The lowest bending mode of a free beam has under 0.3 of it; cords that are stiff bend one of the motions a little.
At 0.95, tests of few and noisy points keep such modes as if the structure had made them."""


def without_suspended(measured: Measured, predictor: Predictor) -> tuple[Measured, tuple[str, ...]]:
    """Take the modes on the suspension from those that have no partner in a free model.

    They lie below all elastic ones. A test of too few points to tell their shapes from others' has all such modes
    taken out: none of them is a sign of something that the structure carries.

    Parameters
    ----------
    measured : Measured
        The test, its modes paired.
    predictor : Predictor
        The model as this test sees it.

    Returns
    -------
    measured : Measured
        The same with fewer ``unpaired`` modes.
    warnings : tuple of str
        Which were taken out.
    """
    alone, count = measured.unpaired, predictor.reduced.structure.rigid_modes
    if alone is None or not count:
        return measured, ()
    below = alone.frequency < measured.frequency.min()
    suspended = below & (_share_as_a_whole(alone, predictor, count) > AS_A_WHOLE)
    if not suspended.any():
        return measured, ()
    warnings = tuple(
        f"mode at {hertz(f)} is the whole structure on its suspension, which the model leaves out"
        for f in alone.frequency[suspended]
    )
    return replace(measured, unpaired=_left(alone, ~suspended)), warnings


def _left(measured: Measured, keep: BoolArray) -> Measured | None:
    return measured.modes(keep) if keep.any() else None


def _share_as_a_whole(measured: Measured, predictor: Predictor, count: int) -> FloatArray:
    """Return how much of each mode's constants motions of the whole body explain, (n_modes,) [-].

    The constants of FRFs that share an end are those of the other end times a number.
    """
    rigid = predictor.nominal_rows["w"] @ predictor.reduced.eigen(NOMINAL)[1][:, :count]
    shared, moving = measured.hit, measured.seen
    if len(np.unique(measured.hit)) > len(np.unique(measured.seen)):
        shared, moving = moving, shared
    explained = np.zeros(len(measured.frequency))
    for end in np.unique(shared):
        rows = shared == end
        basis = np.linalg.qr(rigid[moving[rows]])[0]
        explained += np.sum((basis.T @ measured.constants[rows]) ** 2, axis=0)
    return np.asarray(explained / np.maximum(np.sum(measured.constants**2, axis=0), 1e-300))
