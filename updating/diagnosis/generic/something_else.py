"""How probable it is that the cause is in no library, and what that cause would be."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.special import expit, logit, logsumexp

from updating.diagnosis.answer.in_no_library import RegionalChange, SomethingElse
from updating.diagnosis.answer.rules import DecisionRules
from updating.diagnosis.generic.field import Field, beside
from updating.diagnosis.generic.parts import channels, parts
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Compared, Search
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.prior import log_prior
from updating.models.spec import Spec
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

NAMES: tuple[Literal["stiffness"], Literal["mass"]] = ("stiffness", "mass")
"""What each of ``PROPERTIES`` is called in an answer."""


def something_else(problem: DiagnosisProblem, found: Search, rules: DecisionRules) -> SomethingElse | None:
    """Compare a cause outside the library against all sets, and beside the first of them.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : Search
        What was compared.
    rules : DecisionRules
        The prior of such a cause.

    Returns
    -------
    SomethingElse or None
        None of several specimens, and of matrices without regions: no field of theirs is known.
    """
    sets = [row for row in found.compared if row.names]
    if not isinstance(problem, SpecimenProblem) or not problem.predictor.spec.regions or not sets:
        return None
    prior = logit(rules.something_else_prior)
    own = [row.log_score for row in (*sets, *found.set_aside)]
    first = beside(problem, sets[0].explanation)
    alone = [(one, beside(problem, one)) for one in _without_effects(problem, found)]
    scores = [one.log_evidence + field.log_factor for one, field in alone]
    evidence = float(logsumexp(scores)) + prior
    more = [one + prior for one in _first_and_more(problem, found, sets[0], first)]
    others = logsumexp([*own, *more])
    share = float(expit(evidence - others)) if np.isfinite(evidence) else 0.0
    best = alone[int(np.argmax(scores))][1]
    return SomethingElse(
        share, first.log_factor, _changes(problem.predictor.spec, best), channels(best), parts(problem, best)
    )


def _first_and_more(problem: SpecimenProblem, found: Search, row: Compared, first: Field) -> list[float]:
    """Return the logarithm of the evidence and prior of the first set with a cause in no library beside it.

    What that cause does beside the set is no evidence for another one. A set that stands with data set aside is
    compared without that, too: the data may be that cause's.
    """
    prior, one = log_prior(len(row.names), found.examined), row.explanation
    scores = [one.log_evidence + first.log_factor + prior]
    if one.candidate.outliers:
        plain = replace(one.candidate, outliers=())
        stated = explain(problem, plain, starts=[one.best.coordinates], laplace_only=True)
        if stated.best.possible:
            scores.append(stated.log_evidence + beside(problem, stated).log_factor + prior)
    return scores


def _without_effects(problem: SpecimenProblem, found: Search) -> list[Explanation]:
    """Return no effect as the sets were compared: on each theory, as the data are stated and with outliers."""
    theories = (False, True) if found.both else (False,)
    half = -float(np.log(len(theories)))
    none = [
        explain(problem, Candidate(fuller=fuller, outliers=outliers))
        for outliers in dict.fromkeys(((), found.empty.explanation.candidate.outliers))
        for fuller in theories
    ]
    return [replace(one, log_evidence=one.log_evidence + half) for one in none]


def _changes(spec: Spec, field: Field, *, least: float = 2.0) -> tuple[RegionalChange, ...]:
    """Return what a field changes of the structure, ``least`` standard deviations or more, what is surest first."""
    names = [*(region.name for region in spec.regions), ""]
    sure = np.abs(field.changes) / np.maximum(field.sigma, 1e-12)
    shown = [(k, i) for k, i in np.argwhere(sure >= least).tolist()]
    return tuple(
        RegionalChange(names[i], NAMES[k], *_percent(field.changes[k, i], field.sigma[k, i]))
        for k, i in sorted(shown, key=lambda one: -sure[one])
    )


def _percent(value: float, sigma: float) -> tuple[float, float, float]:
    """Return a change by its logarithm and the ends of its 95 % interval [%]."""
    low, middle, high = 100 * np.expm1(value + 1.96 * sigma * np.array([-1.0, 0.0, 1.0]))
    return float(middle), float(low), float(high)
