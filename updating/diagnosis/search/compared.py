"""What was compared: every set of effects with its share of the probability, its forms added up.

Data that are worse than stated are an explanation, too: no effect with data set aside stands beside the sets.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, either, explain
from updating.diagnosis.search.prior import count_sets, log_prior
from updating.effects import Obstacle
from updating.likelihood.outliers import Outlier
from updating.problem.candidate import Candidate
from updating.thresholds import FORM_SHARE, HELD_NEAR_END, HELD_SHARE, LEAST_PLACE, NEGLIGIBLE_PROBABILITY


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """An explanation with its share of the probability and how well it fits.

    Parameters
    ----------
    explanation : Explanation
        What was compared.
    probability : float
        Its share [-].
    p_value : float
        How well it fits [-].
    as_stated : float
        How well it fits with no data taken to be worse than stated [-].
    extreme : tuple of str
        Parameters that the data push to an end of their range that is no natural one.
    regions : mapping of str to float
        How its probability is shared among the regions that its forms name; a form that names two gives each half [-].
    without : float
        Log evidence of no effect at all with the same data set aside; of none where none are [-].
    log_score : float
        Logarithm of its evidence times its prior; of what explains no more than data set aside do, none [-].
    forms : tuple of (Explanation, float)
        The same effects in the forms that hold a place's worth of its probability, with their shares of it, the best
        first [-].
    """

    explanation: Explanation
    probability: float
    p_value: float
    as_stated: float
    extreme: tuple[str, ...] = ()
    regions: Mapping[str, float] = field(default_factory=dict)
    without: float = -np.inf
    log_score: float = -np.inf
    forms: tuple[tuple[Explanation, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.explanation.names


@dataclass(frozen=True)
class Searched:
    """How many of the sets of so many causes were searched: those that score tests found the most promising.

    Parameters
    ----------
    causes : int
        Causes in a set.
    sets, possible : int
        How many were searched, and how many there are.
    """

    causes: int
    sets: int
    possible: int


@dataclass(frozen=True, eq=False)
class Search:
    """All that was compared.

    Parameters
    ----------
    nothing : Explanation
        The nominal model with its tolerances.
    compared : tuple of Compared
        All sets of effects, most probable first; the empty set is among them.
    not_examined : dict
        Effects left out, and why.
    both : bool
        Whether every set was compared on the model's theory and on the fuller one.
    examined, repeated : int
        How many effects the sets are made of, and how many of them a set may have twice.
    set_aside : tuple of Compared
        No effect with the data set aside that sets of effects set aside, most probable first: data that are worse than
        stated are an explanation, too.
    """

    nothing: Explanation
    compared: tuple[Compared, ...]
    not_examined: dict[str, Obstacle]
    both: bool = False
    examined: int = 0
    repeated: int = 0
    set_aside: tuple[Compared, ...] = ()

    @property
    def searched(self) -> tuple[Searched, ...]:
        """How many sets of one cause, of two and so on were searched, up to the largest that any was."""
        counts = Counter(len(row.names) for row in self.compared if row.names)
        return tuple(
            Searched(causes, counts[causes], count_sets(causes, self.examined, self.repeated))
            for causes in range(1, 1 + max(counts, default=0))
        )

    @property
    def empty(self) -> Compared:
        """The empty set, with all its outliers."""
        return next(row for row in self.compared if not row.names)


def _examined(found: Sequence[Explanation]) -> int:
    return len({name for e in found for name in e.names})


def _scores(found: Sequence[Explanation]) -> FloatArray:
    """Return the logarithm of evidence and prior of each [-]."""
    examined = _examined(found)
    return np.array([e.log_evidence + log_prior(len(e.names), examined) for e in found])


def compare(found: Sequence[Explanation]) -> list[Compared]:
    """Return explanations with their shares of the probability, in their order, form by form."""
    score = _scores(found)
    probability = np.exp(score - logsumexp(score))
    stated = [0.0 if e.candidate.outliers else e.p_value for e in found]
    return [
        Compared(explanation=e, probability=float(p), p_value=e.p_value, as_stated=s)
        for e, p, s in zip(found, probability, stated, strict=True)
    ]


def extreme_parameters(problem: DiagnosisProblem, explanation: Explanation) -> tuple[str, ...]:
    """Return the parameters whose best value and most of whose posterior lie at an end that is a judgement."""
    found = []
    for i, (name, parameter) in enumerate(problem.parameters(explanation.candidate)):
        best = float(explanation.best.coordinates[i])
        away = np.abs(explanation.samples[:, i] - round(best))
        if parameter.extreme(best) and explanation.weights[away > HELD_NEAR_END].sum() < 1 - HELD_SHARE:
            found.append(name)
    return tuple(found)


def merged(
    problem: DiagnosisProblem, found: Sequence[Explanation], *, both: bool
) -> tuple[tuple[Compared, ...], tuple[Compared, ...]]:
    """Add up the forms of each set of effects; the most probable form stands for them.

    A set that sets data aside is compared with no effect that sets the same aside. Where it is not the more probable it
    explains nothing, and has no share; the data that are worse than stated have it.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : sequence of Explanation
        Every form of every set.
    both : bool
        Whether they were compared on two theories.

    Returns
    -------
    compared, set_aside : tuples of Compared
        As in :class:`Search`.
    """
    forms: dict[tuple[str, ...], list[Compared]] = {}
    for row in compare(found):
        forms.setdefault(tuple(sorted(row.names)), []).append(row)
    rows = []
    without: dict[tuple[Outlier, ...], Explanation] = {}
    for own in forms.values():
        top = max(own, key=lambda row: row.probability)
        total = float(logsumexp([row.explanation.log_evidence for row in own]))
        fits = max(row.p_value for row in own if row.probability >= FORM_SHARE * top.probability)
        candidate, least = top.explanation.candidate, -np.inf
        if candidate.outliers and top.names:
            if candidate.outliers not in without:
                without[candidate.outliers] = _without_effects(problem, candidate.outliers, both=both)
            least = without[candidate.outliers].log_evidence
        explains = total > least or not top.names
        probability = sum(row.probability for row in own) if explains else 0.0
        extreme = extreme_parameters(problem, top.explanation) if probability > NEGLIGIBLE_PROBABILITY else ()
        rows.append(
            Compared(
                explanation=replace(top.explanation, log_evidence=total),
                probability=probability,
                p_value=fits,
                as_stated=max(row.as_stated for row in own),
                extreme=extreme,
                regions=_by_region(own, total),
                without=least,
                log_score=total + log_prior(len(top.names), _examined(found)) if explains else -np.inf,
                forms=_by_form(own, sum(row.probability for row in own)),
            )
        )
    return _shared(rows, _aside(found, list(without.values())))


def _without_effects(problem: DiagnosisProblem, outliers: tuple[Outlier, ...], *, both: bool) -> Explanation:
    """Return no effect with data set aside, on either theory where sets were compared on both."""
    plain = explain(problem, Candidate(outliers=outliers))
    return either(plain, explain(problem, Candidate(fuller=True, outliers=outliers))) if both else plain


def _aside(found: Sequence[Explanation], without: list[Explanation]) -> list[Compared]:
    """Return no effect with data set aside, with its share beside all that was found.

    An odd shape, channel or damping ratio is a slip of a test in which nothing is hidden. A frequency that belongs
    elsewhere is a gap by itself: as likely, beforehand, as any one cause.
    """
    examined, level = _examined(found), logsumexp(_scores(found))
    known = {e.candidate.outliers for e in found if not e.names}
    rows = []
    for one in without:
        if one.candidate.outliers in known:
            continue
        gap = any(outlier.of_frequency for outlier in one.candidate.outliers)
        score = one.log_evidence + log_prior(int(gap), examined)
        share = float(np.exp(score - level))
        rows.append(
            Compared(explanation=one, probability=share, p_value=one.p_value, as_stated=0.0, log_score=score)
        )
    return rows


def _shared(rows: list[Compared], aside: list[Compared]) -> tuple[tuple[Compared, ...], tuple[Compared, ...]]:
    """Return rows of two kinds, each the most probable first, with shares that add up to one."""
    total = sum(row.probability for row in (*rows, *aside))
    first, second = (
        tuple(sorted((replace(row, probability=row.probability / total) for row in part), key=_improbable))
        for part in (rows, aside)
    )
    return first, second


def _improbable(row: Compared) -> float:
    return -row.probability


def _by_form(own: list[Compared], total: float) -> tuple[tuple[Explanation, float], ...]:
    """Return the forms of one set that hold enough of its probability to be named, with their shares of it [-]."""
    shares = [(row.explanation, row.probability / total) for row in own if total > 0]
    probable = [(one, share) for one, share in shares if share >= LEAST_PLACE]
    return tuple(sorted(probable, key=lambda form: -form[1]))


def _by_region(own: list[Compared], total: float) -> dict[str, float]:
    """Return how the evidence of one set's forms is shared among the regions that they name [-]."""
    shares: dict[str, float] = {}
    for row in own:
        named = [str(f.values["region"]) for f in row.explanation.candidate.forms if "region" in f.values]
        for name in named:
            share = float(np.exp(row.explanation.log_evidence - total)) if np.isfinite(total) else 0.0
            shares[name] = shares.get(name, 0.0) + share / len(named)
    return shares if sum(shares.values()) > 0 else {}
