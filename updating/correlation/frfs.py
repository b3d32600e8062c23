"""Measured FRFs beside the model's at the same points: overlay and FRAC."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition import FORMS, FrfSet, StudyError
from acquisition.arrays import FloatArray, IntArray
from acquisition.display import Displayed
from identification import frac
from identification.arrangement import signs
from updating.prediction.matching import Paired
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.simulation import UNKNOWN_DAMPING, identified_ratios, receptances, simulated, with_ratios
from updating.test_data.measured import Measured


@dataclass(frozen=True, eq=False)
class CorrelatedFrfs(Displayed):
    """Measured FRFs and a model's.

    Parameters
    ----------
    measured, model : FrfSet
        The same degrees of freedom on the same lines, both as the transducers point.
    frac : (n_frf,) array
        FRAC of each pair [-].
    damping : str
        Where the model's damping is from.
    """

    measured: FrfSet
    model: FrfSet
    frac: FloatArray
    damping: str


def correlate_frfs(
    frfs: FrfSet, measured: Measured, predictor: Predictor, prediction: Prediction, paired: Paired
) -> CorrelatedFrfs:
    """Compute a model's FRFs at the points, lines, form and window of measured ones.

    They are solved on the reduced basis, which holds the static answers at the points. The damping is the model's
    own, by regions and therefore coupling its modes where it states so; else the identified ratios.

    Parameters
    ----------
    frfs : FrfSet
        Those the test was identified from, or others of the same study.
    measured : Measured
        The test.
    predictor : Predictor
        The model.
    prediction, paired : Prediction, Paired
        Its modes, and which of them are the test's.

    Raises
    ------
    StudyError
        If none of the FRFs is between points of the test.
    """
    theirs, ours, turned = _found(frfs, measured)
    part = frfs.select(theirs)
    if part.laplace[0] == 0:  # where a receptance may not exist
        part = part.band(part.df / 2, float(part.frequency[-1]))
    damped, damping = _damped(predictor, prediction, paired)
    model = simulated(damped)
    receptance = receptances(
        model, part.laplace, seen=measured.seen[ours], hit=measured.hit[ours], method="direct"
    )
    form = (part.laplace + model.decay) ** FORMS.index(part.form)
    values = receptance * form * turned[:, None]
    own = replace(part, values=values, coherence=None, variance=None, averages=None, source="model")
    return CorrelatedFrfs(part, own, frac(part.values, values), damping)


def _found(frfs: FrfSet, measured: Measured) -> tuple[IntArray, IntArray, FloatArray]:
    """Return rows of FRFs, the rows of the test they are, and the signs that turn the model's like them."""
    ends = [(r.node, f.node) for r, f in zip(frfs.responses, frfs.references, strict=True)]
    own = [
        (measured.nodes[s], measured.nodes[h] if h >= 0 else None)
        for s, h in zip(measured.seen.tolist(), measured.hit.tolist(), strict=True)
    ]
    rows, way = measured.rows, measured.signs
    if rows is not None and way is not None and _same(ends, own, rows):
        return rows, np.arange(len(own)), signs(frfs)[rows] * way
    known = {pair: i for i, pair in enumerate(own)}
    theirs = np.array([i for i, pair in enumerate(ends) if pair in known], dtype=int)
    if not len(theirs):
        raise StudyError(
            f"{frfs.source}: none of these FRFs belongs to the test; give the FRFs of the same study"
        )
    ours = np.array([known[ends[i]] for i in theirs.tolist()])
    return theirs, ours, signs(frfs)[theirs]


def _same(ends: Sequence[tuple[int, int]], own: Sequence[tuple[int, int | None]], rows: IntArray) -> bool:
    """Return whether these are the FRFs that were identified, in whose order the test has its constants."""
    return rows.max(initial=-1) < len(ends) and [ends[i] for i in rows.tolist()] == list(own)


def _damped(predictor: Predictor, prediction: Prediction, paired: Paired) -> tuple[Predictor, str]:
    if predictor.expects_damping:
        return predictor, "the model's own damping"
    ratios = identified_ratios(paired, prediction)
    if ratios is not None:
        return with_ratios(
            predictor, ratios
        ), "identified damping ratios, their median where no mode is paired"
    source = f"a damping ratio of {100 * UNKNOWN_DAMPING:g} %, as neither test nor model states any"
    return with_ratios(predictor, np.array([UNKNOWN_DAMPING])), source
