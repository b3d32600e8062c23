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

ROUNDING = 1e-6
"""Singular values of the motions of a whole body under this share of the largest are rounding [-]."""


def without_suspended(measured: Measured, predictor: Predictor) -> tuple[Measured, tuple[str, ...]]:
    """Take the modes on the suspension from those that have no partner in a free model.

    They lie below all elastic ones, and are as many at the most as the test can tell motions of the whole body apart. A
    test of too few points to tell their shapes from others' has so many taken out. A mass on a spring that swings far
    below the first elastic mode moves the body as a whole, too, and is not distinguished from cords.

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
    rigid = predictor.nominal_rows["w"] @ predictor.reduced.eigen(NOMINAL)[1][:, :count]
    motions = _independent(rigid)
    below = alone.frequency < measured.frequency.min()
    like = np.flatnonzero(below & (_share_as_a_whole(alone, motions) > AS_A_WHOLE))
    if not len(like):
        return measured, ()
    lowest = like[np.argsort(alone.frequency[like])][: motions.shape[1]]
    suspended = np.isin(np.arange(len(below)), lowest)
    warnings = tuple(
        f"mode at {hertz(f)} is the whole structure on its suspension, which the model leaves out"
        for f in alone.frequency[suspended]
    )
    return replace(measured, unpaired=_left(alone, ~suspended)), warnings


def _left(measured: Measured, keep: BoolArray) -> Measured | None:
    return measured.modes(keep) if keep.any() else None


def _independent(columns: FloatArray) -> FloatArray:
    """Return orthonormal columns that span the same: seen along one axis, six motions of a body are three."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, size > ROUNDING * size.max(initial=0.0)])


def _share_as_a_whole(measured: Measured, motions: FloatArray) -> FloatArray:
    """Return how much of each mode's constants motions of the whole body (n_points, k) explain, (n_modes,) [-].

    The constants of FRFs that share an end are those of the other end times a number.
    """
    shared, moving = measured.hit, measured.seen
    if len(np.unique(measured.hit)) > len(np.unique(measured.seen)):
        shared, moving = moving, shared
    rows = np.ones(len(shared), dtype=bool) if measured.trusted is None else measured.trusted
    explained = np.zeros(len(measured.frequency))
    for end in np.unique(shared[rows]):
        own = rows & (shared == end)
        basis = _independent(motions[moving[own]])
        explained += np.sum((basis.T @ measured.constants[own]) ** 2, axis=0)
    return np.asarray(explained / np.maximum(np.sum(measured.constants[rows] ** 2, axis=0), 1e-300))
