"""What the best explanation leaves beyond noise, and which data carry it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import BoolArray
from updating.diagnosis.answer.closing import Remainder, Shrink
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.set_aside import of_channel, of_mode
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.likelihood.cells import cells


def remainder_of(
    problem: DiagnosisProblem,
    titles: Sequence[str],
    best: Explanation,
    shrink: Shrink,
    *,
    rules: DecisionRules = DEFAULT_RULES,
) -> Remainder:
    """State what an explanation leaves.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    titles : sequence of str
        Of the studies; given where there are several.
    best : Explanation
        The set of effects.
    shrink : Shrink
        How far it closes the gap.
    rules : DecisionRules
        What the answer is decided by.
    """
    point, outliers = best.best, best.candidate.outliers
    comparison = point.comparison
    as_stated = problem.at(replace(best.candidate, outliers=()), point.coordinates, point.about)
    stated = point.marginal.settle(as_stated).noise(point.marginal.scale)
    off = np.where(comparison.of_pairs, np.abs(point.left_over) / np.sqrt(stated), 0.0)
    group = cells(comparison)
    strength = np.sqrt(group.sums(off**2) / np.maximum(group.sums(comparison.of_pairs.astype(float)), 1.0))
    order = [int(i) for i in np.argsort(strength)[::-1] if group.size[i]]
    significant = best.p_value < rules.doubted_fit or bool(outliers)
    carried = [i for i in order if strength[i] > rules.notable_remainder] if significant else []
    beyond = max(shrink.after**2 - shrink.floor**2, 0.0)
    return Remainder(
        significant,
        float(np.sqrt(beyond)),
        float(strength.max(initial=0.0)),
        tuple(dict.fromkeys(_name_of(problem, titles, best, group.members(i)) for i in carried)),
    )


def _name_of(problem: DiagnosisProblem, titles: Sequence[str], best: Explanation, rows: BoolArray) -> str:
    """Name a cell: a kind of data of one mode, or all constants of one measuring channel."""
    comparison = best.best.comparison
    first = int(np.flatnonzero(rows)[0])
    modes = np.unique(comparison.mode[rows & comparison.of_pairs])
    if len(modes) == 1:
        return of_mode(problem, titles, int(modes[0]), int(comparison.channel[first]))
    return of_channel(problem, titles, int(comparison.source[first]))
