"""One cause fewer: the parts of the best set, searched from where they are in it.

A set finds the sizes of its causes from many places; a part of it that explains the data as well may have missed them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.problem.candidate import Candidate
from updating.thresholds import MISSED_MAXIMUM


def with_parts(problem: DiagnosisProblem, found: Sequence[Explanation]) -> list[Explanation]:
    """Return what was found, the parts of the best set of several causes as good as they are in it.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : sequence of Explanation
        All sets scored so far.
    """
    sets = [e for e in found if len(set(e.names)) == len(e.names) > 1 and not e.candidate.outliers]
    if not sets:
        return list(found)
    best, kept = max(sets, key=lambda e: e.log_evidence), list(found)
    for left in range(len(best.names)):
        part = _without(problem, best, left)
        alike = [e for e in kept if _same(e.candidate, part.candidate)]
        reached = max((e.best.marginal.log_likelihood for e in alike), default=-np.inf)
        if part.best.marginal.log_likelihood > reached + MISSED_MAXIMUM:
            kept = [e for e in kept if not any(e is other for other in alike)] + [part]
    return kept


def _without(problem: DiagnosisProblem, whole: Explanation, left: int) -> Explanation:
    """Draft a set without one of its effects, from where the others are."""
    candidate = whole.candidate
    singles = [
        Candidate((effect,), fuller=candidate.fuller, chosen=(form,))
        for effect, form in zip(candidate.effects, candidate.forms, strict=True)
    ]
    ends = np.cumsum([0, *(len(problem.parameters(single)) for single in singles)])
    others = [i for i in range(len(singles)) if i != left]
    part = Candidate(
        tuple(candidate.effects[i] for i in others),
        fuller=candidate.fuller,
        chosen=tuple(candidate.forms[i] for i in others),
    )
    start = np.concatenate([whole.best.coordinates[ends[i] : ends[i + 1]] for i in others])
    return explain(problem, part, starts=[start], laplace_only=True)


def _same(one: Candidate, other: Candidate) -> bool:
    """Return whether two candidates are the same effects in the same forms, in any order, on whichever theory."""
    if one.outliers or len(one.effects) != len(other.effects):
        return False
    forms = [sorted((e.key, str(f)) for e, f in zip(c.effects, c.forms, strict=True)) for c in (one, other)]
    return forms[0] == forms[1]
