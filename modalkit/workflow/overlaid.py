"""Measured FRFs with those of the unchanged model and of the model with the best explanation in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition import FrfSet
from acquisition.arrays import IntArray
from acquisition.form import FORMS
from identification import frac
from modalkit.workflow.fitted import Fitted
from updating.correlation.frfs import CorrelatedFrfs, correlate_frfs
from updating.models.state import State
from updating.prediction.matching import pair_modes
from updating.prediction.predict import Predictor
from updating.test_data.measured import UNKNOWN_LEVEL

BEYOND = 1.15
"""FRFs are drawn up to so many times the highest mode compared [-]."""


LINES = 4096
"""Most lines on which a model is solved for the drawing."""


@dataclass(frozen=True, eq=False)
class Overlaid:
    """Measured FRFs and a model's before and after.

    Parameters
    ----------
    before : CorrelatedFrfs
        With the unchanged model, a baseline's correction included.
    after : CorrelatedFrfs, optional
        With the best explanation in it.
    every : int
        So many lines apart, of those measured.
    levelled : bool
        Whether the models were scaled to the level of the test, which is not known.
    """

    before: CorrelatedFrfs
    after: CorrelatedFrfs | None
    every: int = 1
    levelled: bool = False


def overlaid(frfs: FrfSet, best: Fitted) -> Overlaid:
    """Compute the model's FRFs before and after.

    Parameters
    ----------
    frfs : FrfSet
        Those the test was identified from.
    best : Fitted
        The best explanation.

    Raises
    ------
    StudyError
        If none of the FRFs is between points of the test.
    """
    top = BEYOND * float(best.problem.measured.frequency.max())
    part = selected_lines(frfs.band(0.0, top) if frfs.frequency[0] < top < frfs.frequency[-1] else frfs)
    found, before = best.model(), best.problem.predictor
    after = None if found is None else _after(part, best, *found)
    both = Overlaid(_beside(part, best, before), after, round(part.df / frfs.df))
    test = best.problem.measured
    if test.absolute and test.calibration <= UNKNOWN_LEVEL:
        return both
    levelled = None if both.after is None else _levelled(both.after)
    return replace(both, before=_levelled(both.before), after=levelled, levelled=True)


def _levelled(both: CorrelatedFrfs) -> CorrelatedFrfs:
    """Return a model's FRFs times the median ratio of the measured ones to them."""
    size, own = np.abs(both.measured.values), np.abs(both.model.values)
    known = (size > 0) & (own > 0)
    factor = float(np.exp(np.median(np.log(size[known] / own[known])))) if known.any() else 1.0
    return replace(both, model=replace(both.model, values=factor * both.model.values))


def selected_lines(frfs: FrfSet) -> FrfSet:
    """Return FRFs on every n-th line, where they have more than :data:`LINES`."""
    every = -(-len(frfs.frequency) // LINES)
    if every == 1:
        return frfs
    return replace(
        frfs,
        frequency=frfs.frequency[::every],
        values=frfs.values[:, ::every],
        coherence=None,
        variance=None,
        scatter=None,
    )


def _beside(frfs: FrfSet, best: Fitted, predictor: Predictor) -> CorrelatedFrfs:
    prediction = predictor.predict(at_least=best.problem.reach)
    measured = best.problem.measured
    return correlate_frfs(frfs, measured, predictor, prediction, pair_modes(measured, prediction))


def _after(frfs: FrfSet, best: Fitted, predictor: Predictor, state: State) -> CorrelatedFrfs:
    """Return the model's FRFs as the measurement has them: at its level, with reversed or exchanged points, delayed."""
    both = at_level(frfs, 1.0 + state.slope * (best.problem.measured.level or 0.0), best, predictor)
    nodes = best.problem.measured.nodes
    values = both.model.values[_exchanged(both.measured, nodes, state)]
    for (role, point), gain in state.point_gains.items():
        dofs = both.measured.responses if role == "seen" else both.measured.references
        concerned = np.array([dof.node == nodes[point] for dof in dofs])
        values = np.where(concerned[:, None], gain * values, values)
    values = values * np.exp(-2j * np.pi * both.measured.frequency * state.delay)
    return replace(both, model=replace(both.model, values=values), frac=frac(both.measured.values, values))


def at_level(frfs: FrfSet, shift: float, best: Fitted, predictor: Predictor) -> CorrelatedFrfs:
    """Return a model's FRFs where all its frequencies are shifted, as by joints that soften with the level of the hits.

    A model whose stiffness is s^2 times another's, with the same damping ratios, answers at s p as that one at p:
    H(s p) = s^(n-2) H(p) for receptances (n = 0), mobilities (1) and accelerances (2).

    Parameters
    ----------
    frfs : FrfSet
        The measured ones.
    shift : float
        s, the factor of all frequencies [-].
    best : Fitted
        Test and model.
    predictor : Predictor
        The model, of whose matrices the shift is no part.
    """
    if shift == 1.0:
        return _beside(frfs, best, predictor)
    there = replace(frfs, frequency=frfs.frequency / shift, decay=frfs.decay / shift)
    both = _beside(there, best, predictor)
    values = shift ** (FORMS.index(frfs.form) - 2) * both.model.values
    measured = replace(both.measured, frequency=both.measured.frequency * shift, decay=frfs.decay)
    model = replace(both.model, frequency=measured.frequency, decay=frfs.decay, values=values)
    return replace(both, measured=measured, model=model, frac=frac(measured.values, values))


def _exchanged(frfs: FrfSet, nodes: tuple[int, ...], state: State) -> IntArray:
    """Return, for each FRF, the row that was really measured under its name."""
    ends = [(r.node, f.node) for r, f in zip(frfs.responses, frfs.references, strict=True)]
    rows = {pair: i for i, pair in enumerate(ends)}
    for role, a, b in state.exchanged:
        other = {nodes[a]: nodes[b], nodes[b]: nodes[a]}
        ends = [(other.get(s, s), h) if role == "seen" else (s, other.get(h, h)) for s, h in ends]
    return np.array([rows.get(pair, i) for i, pair in enumerate(ends)], dtype=np.int64)
