"""What the reader of a diagnosis should know about how it was reached."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import norm

from acquisition.quantities import quantity
from updating.diagnosis.answer.consistency import Split
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.problem.doubtful import notes_on_doubtful
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.points import Point
from updating.problem.gates import notes_on, on_levels, on_modes, on_reduction
from updating.thresholds import NEGLIGIBLE_PROBABILITY, REJECTED_FIT


def on_rules(rules: DecisionRules) -> list[str]:
    """Return which rules differ from the defaults, and by what."""
    stated = [
        f"{name} = {value:g} (default: {getattr(DEFAULT_RULES, name):g})"
        for name, value in rules.changed.items()
    ]
    return (
        [f"the verdict was decided by rules that differ from the defaults: {', '.join(stated)}"]
        if stated
        else []
    )


def on_fit(
    leader: Explanation, inconsistent: Sequence[Split], *, significant: bool, fewest: int = 6
) -> list[str]:
    """Return what the reader should know about how far the data bear the first set of causes.

    What is left of fewer than ``fewest`` data beyond its parameters scatters by a third, so that it is weak evidence
    on the noise.
    """
    notes = [f"{' + '.join(leader.names)}: {split}, so it is not named" for split in inconsistent[:1]]
    if not significant:
        return notes
    beyond = len(leader.best.comparison.residual) - len(leader.best.coordinates)
    if leader.names and beyond < fewest:
        notes.append(
            f"only {beyond} data are left to test the fit of {' + '.join(leader.names)}, so it depends on the stated "
            "noise; measure more modes, or shapes"
        )
    return notes


def on_search(problem: DiagnosisProblem, found: Search, sets: tuple[tuple[str, ...], ...]) -> list[str]:
    """Return what the reader should know about how the answer was reached."""
    notes = []
    if found.both:
        notes.append(
            "the model's theory neglects shear and rotary inertia, which exceed the noise: every set of "
            "causes was compared with and without them"
        )
    notes += _on_samples(found)
    leader = found.compared[0]
    if leader.p_value >= REJECTED_FIT:
        notes += on_marks(problem, leader.explanation.best, " + ".join(leader.names) or "no cause")
    for one in problem.specimens:
        notes += notes_on_doubtful(one, " or ".join(" + ".join(names) for names in sets))
        if one.theory_error is not None:
            notes += notes_on(one.theory_error, one.measured, one.predictor.spec)
        notes += on_reduction(one.predictor, len(one.measured.frequency))
        notes += on_modes(one.measured, one.predictor.predict(at_least=one.reach).frequency, one.order)
        wet = one.predictor.environment.fluid_density is not None
        acting = [effect for row in found.compared[:1] for effect in row.explanation.candidate.effects]
        wet |= any("in air" in effect.undone_by for effect in acting)
        notes += on_levels(one.measured, fluid=wet)
    return notes


def _on_samples(found: Search) -> list[str]:
    """Return which of the two most probable sets rest on few samples."""
    return [
        f"the probability and the intervals of {' + '.join(row.names) or 'no cause'} are rough: they come from "
        f"{row.explanation.effective:.0f} effective samples; {row.explanation.wanted:.0f} are needed"
        for row in found.compared[:2]
        if row.probability > NEGLIGIBLE_PROBABILITY
        and row.explanation.samples.shape[1]
        and 0 < row.explanation.effective < row.explanation.wanted
    ]


def on_marks(problem: DiagnosisProblem, best: Point, cause: str) -> list[str]:
    """Return which points an answer has farther from where they are stated than chance puts any of them."""
    moved = best.marginal.shift[best.comparison.moving]
    count = sum(marks.doubt.size for one in problem.specimens for marks in one.marks)
    notes, first = [], 0
    for one in problem.specimens:
        first += len(one.names)
        for marks in one.marks:
            away = moved[first : first + marks.doubt.size].reshape(marks.doubt.shape)
            first += marks.doubt.size
            k, axis = np.unravel_index(np.abs(away).argmax(), away.shape)
            if count * 2 * norm.sf(abs(away[k, axis])) < REJECTED_FIT:
                what = "the hits" if marks.end == "hit" else "the sensor"
                notes.append(
                    f"{cause} fits only if {what} of point {one.measured.nodes[marks.points[k]]} lay "
                    f"{quantity(float(abs(away[k, axis]) * marks.doubt[k, axis]), 'm')} from the stated place "
                    f"({abs(away[k, axis]):.0f} standard deviations): check where it was"
                )
    return notes
