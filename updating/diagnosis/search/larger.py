"""Larger sets of causes: one more beside the best sets of one cause less."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.together import join, once_more, same_place_twice, score_tests
from updating.steps import Steps
from updating.thresholds import LARGER_SETS, SETS_ENLARGED


@dataclass(frozen=True, eq=False)
class _Draft:
    """A set and one more effect that may be searched together.

    Parameters
    ----------
    base, other : Explanation
        The set, and the effect alone.
    promise : float
        The log-likelihood that a linear step from the set's best would reach, with the prior share of the form.
    """

    base: Explanation
    other: Explanation
    promise: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all effects, sorted."""
        return tuple(sorted(self.base.names + self.other.names))


def one_more(
    problem: DiagnosisProblem, found: list[Explanation], causes: int, steps: Steps
) -> list[Explanation]:
    """Add to the best sets the single effects that a score test finds the most promising.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : list of Explanation
        All sets scored so far.
    causes : int
        How many causes the larger sets have.
    steps : Steps
        Where it is announced how many are compared.
    """
    bases = [e for e in found if len(e.names) == causes - 1 and e.best.possible]
    bases.sort(key=lambda e: -e.log_evidence)
    singles = [e for e in found if len(e.names) == 1 and e.best.possible]
    drafts: dict[tuple[str, ...], _Draft] = {}
    promised = [d for base in _unlike(bases)[:SETS_ENLARGED] for d in _drafts(problem, base, singles)]
    for draft in sorted(promised, key=lambda draft: -draft.promise):
        drafts.setdefault(draft.names, draft)
    bar = max((e.best.marginal.log_likelihood for e in bases), default=0.0)
    larger: list[Explanation] = []
    for draft in steps.each(list(drafts.values())[:LARGER_SETS]):
        base, other = draft.base, draft.other
        whole = (base.candidate, base.best.coordinates)
        larger.append(join(problem, whole, (other.candidate, other.best.coordinates), bar))
        bar = max(bar, larger[-1].best.marginal.log_likelihood)
    return larger


def _unlike(bases: list[Explanation]) -> list[Explanation]:
    """Return the best form of each set."""
    best: dict[tuple[str, ...], Explanation] = {}
    for base in bases:
        best.setdefault(tuple(sorted(base.names)), base)
    return list(best.values())


def _drafts(problem: DiagnosisProblem, base: Explanation, singles: list[Explanation]) -> Iterator[_Draft]:
    """Yield what a set may be enlarged by: fewer parameters than data, one of its own once more at most, elsewhere."""
    data = len(base.best.comparison.residual)
    others = [
        once_more(e) if e.names[0] in base.names else e
        for e in singles
        if base.names.count(e.names[0]) < (2 if e.candidate.effects[0].repeats_on(problem.predictor) else 1)
        and not same_place_twice(problem, base.candidate, e.candidate)
        and len(base.best.coordinates) + len(e.best.coordinates) < data - 1
    ]
    if not others:
        return
    reached = score_tests(problem, [base, *others])[0, 1:]
    for other, height in zip(others, reached, strict=True):
        yield _Draft(base, other, float(height) + other.candidate.log_weight)
