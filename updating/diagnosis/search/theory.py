"""Sets that need the fuller theory of a model: where a theory is a cause like others, it is one of theirs.

Single causes are compared on the model's theory and on the fuller one with half of their evidence each, sets put
together from them on that of the better part. One that is far better on the fuller theory has one cause more, and the
prior of such a set; beside those on the model's own theory the fuller one is tried.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.fit import highest
from updating.diagnosis.search.prior import log_prior
from updating.effects import Effect, Variant
from updating.problem.candidate import Candidate
from updating.thresholds import COUNT_PRIOR


def with_theory_named(
    problem: DiagnosisProblem, found: Sequence[Explanation], effects: Sequence[Effect]
) -> list[Explanation]:
    """Return explanations, the theory among the causes of those that are better on the fuller one by its prior.

    Parameters
    ----------
    problem : DiagnosisProblem
        Test and model.
    found : sequence of Explanation
        Sets as they were compared, each on the better theory.
    effects : sequence of Effect
        All that are examined; without a theory among them nothing is renamed.
    """
    theory = next((effect for effect in effects if effect.fuller), None)
    if theory is None:
        return list(found)
    named = [_named(problem, one, theory, len(effects)) for one in found]
    renamed = {_key(new) for old, new in zip(found, named, strict=True) if new is not old}
    kept = [new for old, new in zip(found, named, strict=True) if new is not old or _key(new) not in renamed]
    known = {_key(one) for one in kept}
    beside = [
        one for one in kept if not (one.laplace_only or one.candidate.fuller or theory.name in one.names)
    ]
    tried = [_with(problem, one, theory) for one in beside if len(one.names) + 1 < len(COUNT_PRIOR)]
    return kept + [one for one in tried if _key(one) not in known]


def _with(problem: DiagnosisProblem, one: Explanation, theory: Effect) -> Explanation:
    """Draft a set together with the theory: what that moves is small, so that the maxima stay near."""
    bar = one.best.marginal.log_likelihood
    return explain(problem, _whole(one.candidate, theory), starts=one.tops, laplace_only=True, bar=bar)


def _whole(candidate: Candidate, theory: Effect) -> Candidate:
    """Return a set with the theory among its causes."""
    return Candidate(
        (*candidate.effects, theory), chosen=(*candidate.forms, Variant()), outliers=candidate.outliers
    )


def _named(problem: DiagnosisProblem, one: Explanation, theory: Effect, examined: int) -> Explanation:
    """Return an explanation with the theory among its causes where the data ask for it; drafts stay as they are."""
    candidate, causes = one.candidate, len(one.names)
    if not candidate.fuller or one.laplace_only:
        return one
    if theory.name in one.names:  # a pair of it with a set on that theory already
        return replace(one, candidate=replace(candidate, fuller=False))
    if causes + 1 >= len(COUNT_PRIOR):
        return one
    costs = log_prior(causes, examined) - log_prior(causes + 1, examined)
    if _behind(problem, one) > np.exp(-costs):
        return one
    whole = _whole(candidate, theory)
    return replace(one, candidate=whole, log_evidence=one.log_evidence - one.other, other=0.0)


def _behind(problem: DiagnosisProblem, one: Explanation) -> float:
    """Return the evidence that a set has on the model's own theory, over that on the fuller one [-].

    Sets put together from others were compared on the fuller theory alone: of these the likelihoods are compared.
    """
    if one.other:
        return float(2.0 * np.exp(one.other) - 1.0)
    plain = highest(problem, replace(one.candidate, fuller=False), one.best.coordinates)
    return float(np.exp(plain.marginal.log_likelihood - one.best.marginal.log_likelihood))


def _key(one: Explanation) -> tuple[object, ...]:
    """Return by what explanations differ: effects with their forms, and outliers, in any order."""
    forms = sorted(
        (effect.name, repr(sorted(form.values.items())))
        for effect, form in zip(one.candidate.effects, one.candidate.forms, strict=True)
    )
    return (*forms, one.candidate.outliers)
