"""Pairs of causes: those that score tests find promising, from near and from far, and one cause twice."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain, combinations_with_replacement, product, zip_longest

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.fit import highest
from updating.diagnosis.search.points import Point, evaluate_many
from updating.diagnosis.search.prior import log_prior
from updating.diagnosis.search.slope import sensitivities
from updating.diagnosis.search.together import (
    Part,
    join,
    joined,
    linear_step,
    once_more,
    same_place_twice,
    score_tests,
)
from updating.effects import Effect
from updating.likelihood.gaussian import normal_equations
from updating.problem.candidate import Candidate
from updating.problem.screening import beside
from updating.steps import Steps
from updating.thresholds import (
    FORMS_TRIED,
    PAIRS_ANEW,
    PAIRS_WEIGHED,
    PLACES_TOGETHER,
    QUANTILE_SPREAD,
    SET_MARGIN,
    SHIFT_SPREAD,
    STEP_INSIDE,
    STEPS_TRIED,
    WITHIN_REACH,
)


def pairs_of(
    problem: DiagnosisProblem, found: list[Explanation], steps: Steps, *, far: bool
) -> list[Explanation]:
    """Evaluate the pairs that promise the most, from the best of either effect alone and from no effect at all.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : list of Explanation
        No effect, and every single one.
    steps : Steps
        Where it is announced how many are compared.
    far : bool
        Whether no single effect explains the data well: the most promising pairs are compared in any case, and tested
        from no effect at all, too, about every starting place of either, an evaluation of each and some for its
        sensitivities. Else only those are compared that promise to come near the best.
    """
    singles = [e for e in found if e.names]
    possible = [e for e in singles if e.best.possible]
    if len(possible) < 2:
        return []
    examined = len({e.names for e in singles})
    best = max(e.log_evidence + log_prior(len(e.names), examined) for e in found)
    volume = [e.best.marginal.log_likelihood - e.log_evidence for e in possible]  # what their parameters cost
    nominal = next(e.best for e in found if not e.names)
    allowed = _allowed(problem, possible)
    reached = score_tests(problem, possible)
    reaches = [_reaches(problem, nominal, e.candidate) for e in possible] if far else []
    both: list[Together] = _together(nominal, reaches, allowed) if far else [[]] * len(allowed)
    drafts = []
    for (i, j), together in zip(allowed, both, strict=True):
        first, second = possible[i], possible[j]
        second = once_more(second) if first.names == second.names else second
        cost = log_prior(2, examined) - volume[i] - volume[j]
        near = max(reached[i, j], reached[j, i]) if i != j else -np.inf
        away = together[0][0] if together else -np.inf
        if far or max(near, away) + cost > best - SET_MARGIN:
            drafts.append(_Draft(first, second, near + cost, away + cost, [u for _, u in together]))
    pairs: list[tuple[Explanation, list[FloatArray]]] = []
    bar = max(e.best.marginal.log_likelihood for e in possible)
    chosen = _promising(drafts)
    if not all(one.predictor.spec.outlined for one in problem.specimens):
        chosen = _best_forms(problem, chosen, drafts)
    for draft in steps.each(chosen):
        parts = [(e.candidate, e.best.coordinates) for e in (draft.first, draft.second)]
        places = draft.places + (_placed(problem, parts) if far else [])
        pair = join(problem, parts[0], parts[1], bar, places=places)
        pairs.append((pair, places))
        bar = max(bar, pair.best.marginal.log_likelihood)
    pairs.sort(key=lambda own: -own[0].log_evidence)
    best_of = [pair for pair, _ in pairs]
    for i, (pair, places) in enumerate(pairs[:PAIRS_ANEW]):
        again = join(problem, *_parts_of_pair(problem, pair), bar, anew=True, places=places)
        other = _in_other_forms(problem, pair, possible, bar)
        best_of[i] = max(pair, again, *other, key=lambda e: e.log_evidence)
        bar = max(bar, best_of[i].best.marginal.log_likelihood)
    return best_of + _alike(problem, possible, best_of, bar)


def _placed(problem: DiagnosisProblem, parts: list[Part]) -> list[FloatArray]:
    """Return the place from which to search where each of two effects fits best beside the other, if either has one."""
    found = beside(parts, problem.predictor) if len(problem.specimens) == 1 else None
    return [] if found is None else [found]


@dataclass(frozen=True, eq=False)
class _Draft:
    """A pair that may be compared.

    Parameters
    ----------
    first, second : Explanation
        The two effects alone.
    near, far : float
        The log evidence that a linear step would reach, with what either's parameters cost alone: from the best of
        either alone, and from no effect at all.
    places : list of arrays
        Prior quantiles of both to start from.
    """

    first: Explanation
    second: Explanation
    near: float
    far: float
    places: list[FloatArray]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the two effects."""
        return tuple(sorted(self.first.names + self.second.names))


def _promising(drafts: list[_Draft]) -> list[_Draft]:
    """Return the pairs that promise the most, from near and from far in turn, of two effects the best form of each."""
    near: dict[tuple[str, ...], _Draft] = {}
    far: dict[tuple[str, ...], _Draft] = {}
    for draft in sorted((d for d in drafts if np.isfinite(d.near)), key=lambda draft: -draft.near):
        near.setdefault(draft.names, draft)
    for draft in sorted((d for d in drafts if np.isfinite(d.far)), key=lambda draft: -draft.far):
        far.setdefault(draft.names, draft)
    in_turn = chain.from_iterable(zip_longest(near.values(), far.values()))
    return list(dict.fromkeys(draft for draft in in_turn if draft is not None))[:PAIRS_WEIGHED]


def _best_forms(problem: DiagnosisProblem, chosen: list[_Draft], drafts: list[_Draft]) -> list[_Draft]:
    """Return the same pairs of effects in the forms that a short maximisation finds best.

    On imported matrices every place is a form of its own, and a linear step errs by more than two neighbours differ.
    """
    found: dict[tuple[str, ...], list[_Draft]] = {}
    for names in dict.fromkeys(draft.names for draft in chosen):
        own = [draft for draft in drafts if draft.names == names]
        near = sorted((d for d in own if np.isfinite(d.near)), key=lambda draft: -draft.near)[:FORMS_TRIED]
        far = sorted((d for d in own if np.isfinite(d.far)), key=lambda draft: -draft.far)[:FORMS_TRIED]
        tried = list(dict.fromkeys([*near, *far]))
        found[names] = (
            sorted(tried, key=lambda draft: -_maximum_after_few_steps(problem, draft))
            if len(tried) > 1
            else tried
        )
    taken = dict.fromkeys(found, 0)
    best = []
    for draft in chosen:
        best.append(found[draft.names][taken[draft.names]])
        taken[draft.names] += 1
    return best


def _maximum_after_few_steps(problem: DiagnosisProblem, draft: _Draft) -> float:
    """Return the log-likelihood, with the forms' shares of the prior, that a pair reaches in a few steps."""
    parts = tuple((e.candidate, e.best.coordinates) for e in (draft.first, draft.second))
    return _after_few_steps(problem, parts[0], parts[1], draft.places[:1])


def _after_few_steps(problem: DiagnosisProblem, first: Part, second: Part, places: list[FloatArray]) -> float:
    """Return the same of two parts, from the best of either alone and from other places of both."""
    (one, a), (two, b) = first, second
    both = joined(one, two)
    starts = [np.concatenate([a, b]), *places]
    reached = [highest(problem, both, start, rounds=STEPS_TRIED).marginal.log_likelihood for start in starts]
    return max(reached) + both.log_weight


def _in_other_forms(
    problem: DiagnosisProblem, pair: Explanation, singles: list[Explanation], bar: float
) -> list[Explanation]:
    """Evaluate a pair with either effect in another of its forms, where a short maximisation finds one that explains
    more.

    Score tests choose the forms of a pair by a linear step from one effect's best, where the other is not yet what it
    is beside it: which law a damping follows shows only once a clamp has taken its share, and so does whether a place
    is softer or stiffer, and where it is.
    """
    parts, found = _parts_of_pair(problem, pair), []
    data, reached = len(pair.best.comparison.residual), pair.best.marginal.log_likelihood
    for (kept, place), (other, _) in (parts, parts[::-1]):
        rivals = [
            (single.candidate, single.best.coordinates)
            for single in sorted(singles, key=lambda e: -e.log_evidence)
            if single.names == other.names
            and single.candidate.forms != other.forms
            and not same_place_twice(problem, kept, single.candidate)
            and len(place) + len(single.best.coordinates) < data
        ]
        tried = rivals[:FORMS_TRIED]
        places = [_placed(problem, [(kept, place), rival]) for rival in tried]
        heights = [
            _after_few_steps(problem, (kept, place), rival, own)
            for rival, own in zip(tried, places, strict=True)
        ]
        if heights and max(heights) > reached + pair.candidate.log_weight:
            best = int(np.argmax(heights))
            found.append(join(problem, (kept, place), tried[best], bar, places=places[best]))
    return found


def _allowed(problem: DiagnosisProblem, singles: list[Explanation]) -> list[tuple[int, int]]:
    """Return which two may be causes together: not one effect twice but at two places, and fewer parameters than data.

    As many parameters as data explain anything.
    """
    allowed = []
    data = len(singles[0].best.comparison.residual)
    for i, j in combinations_with_replacement(range(len(singles)), 2):
        first, second = singles[i], singles[j]
        if first.names == second.names:
            repeats = first.candidate.effects[0].repeats_on(problem.predictor)
            if not repeats or same_place_twice(problem, first.candidate, second.candidate):
                continue
        if len(first.best.coordinates) + len(second.best.coordinates) < data:
            allowed.append((i, j))
    return allowed


@dataclass(frozen=True, eq=False)
class _Reach:
    """What an effect may do about one of its starting places.

    Parameters
    ----------
    place : (k,) array
        Prior quantiles [-].
    columns : (n, 1 + k) array
        Its whole shift, and what every parameter adds, as wide as they are believed to be needed [-].
    """

    place: FloatArray
    columns: FloatArray


def _reaches(problem: DiagnosisProblem, nominal: Point, candidate: Candidate) -> list[_Reach]:
    """Return what an effect may do about each of its starting places, the impossible ones left out."""
    points = evaluate_many(problem, candidate, problem.starts(candidate))
    return [
        _Reach(
            point.coordinates,
            np.column_stack(
                [
                    SHIFT_SPREAD * (nominal.comparison.residual - point.comparison.residual),
                    QUANTILE_SPREAD * sensitivities(problem, candidate, point),
                ]
            ),
        )
        for point in points
        if point.possible
    ]


Together = list[tuple[float, FloatArray]]
"""The log-likelihood that two effects would reach, and the prior quantiles of both to start from, best first."""


def _together(nominal: Point, reaches: list[list[_Reach]], pairs: list[tuple[int, int]]) -> list[Together]:
    """Return from where pairs of effects explain the most, each as much of it as the data ask for.

    Parameters
    ----------
    nominal : Point
        No effect.
    reaches : list of lists
        Of every effect.
    pairs : list of (int, int)
        Which of them are taken together; one with itself is at two of its places.
    """
    flat = [reach for own in reaches for reach in own]
    ends = np.cumsum([0, *(reach.columns.shape[1] for reach in flat)])
    starts = np.cumsum([0, *(len(own) for own in reaches)])
    whole = np.hstack([reach.columns for reach in flat]) if flat else np.zeros((0, 0))
    normal, load = normal_equations(nominal.comparison, whole, nominal.marginal.scale)
    normal += np.eye(len(load))

    def one_step(a: int, b: int) -> FloatArray:
        """Return where a linear step leads from two places, both shifts whole."""
        shifts, free = ends[[a, b]], np.r_[ends[a] + 1 : ends[a + 1], ends[b] + 1 : ends[b + 1]]
        left = load[free] - normal[np.ix_(free, shifts)].sum(axis=1) / SHIFT_SPREAD
        step = QUANTILE_SPREAD * linear_step(normal[np.ix_(free, free)], left)
        return np.clip(np.concatenate([flat[a].place, flat[b].place]) + step, *STEP_INSIDE)

    found = []
    for i, j in pairs:
        own: list[tuple[float, tuple[int, int]]] = []
        for a, b in product(range(starts[i], starts[i + 1]), range(starts[j], starts[j + 1])):
            if i == j and a >= b:
                continue
            columns = np.r_[ends[a] : ends[a + 1], ends[b] : ends[b + 1]]
            step = linear_step(normal[np.ix_(columns, columns)], load[columns])
            reached = nominal.marginal.log_likelihood + 0.5 * float(load[columns] @ step)
            own.append((reached, (a, b)))
        own.sort(key=lambda one: -one[0])
        found.append([(reached, one_step(a, b)) for reached, (a, b) in own[:PLACES_TOGETHER]])
    return found


def _alike(
    problem: DiagnosisProblem, singles: list[Explanation], pairs: list[Explanation], bar: float
) -> list[Explanation]:
    """Try equivalents of each member of the best pair: one of the two in the place of an effect like it.

    Such a rival may fit as well where it alone, at another place, fits too badly for the score test to choose it, or
    where the search from the best of either alone has missed what the best pair shows.
    """
    best = max(pairs, key=lambda e: e.log_evidence, default=None)
    if best is None:
        return []
    near = [e for e in pairs if e.log_evidence > best.log_evidence - WITHIN_REACH]
    known, found = {tuple(sorted(e.names)) for e in near}, []
    data = len(best.best.comparison.residual)
    pair_parts = _parts_of_pair(problem, best)
    for (kept, place), (other, _) in (pair_parts, pair_parts[::-1]):
        for rival in _like(other.effects[0], singles):
            names = tuple(sorted(kept.names + rival.names))
            if (
                names[0] != names[1]
                and names not in known
                and len(place) + len(rival.best.coordinates) < data
            ):
                known.add(names)
                found.append(
                    join(problem, (kept, place), (rival.candidate, rival.best.coordinates), bar, anew=True)
                )
    return found


def _parts_of_pair(problem: DiagnosisProblem, pair: Explanation) -> tuple[Part, Part]:
    """Take a pair apart."""
    whole = pair.candidate
    first, second = (
        Candidate((effect,), fuller=whole.fuller, chosen=(form,))
        for effect, form in zip(whole.effects, whole.forms, strict=True)
    )
    count = len(problem.parameters(first))
    return (first, pair.best.coordinates[:count]), (second, pair.best.coordinates[count:])


def _like(effect: Effect, singles: list[Explanation]) -> list[Explanation]:
    """Return the best form of every single that is declared to resemble an effect, or that the effect declares."""
    best: dict[str, Explanation] = {}
    for single in singles:
        for other in single.candidate.effects:
            alike = other.name in effect.equivalent_to or effect.name in other.equivalent_to
            if alike and (other.name not in best or best[other.name].log_evidence < single.log_evidence):
                best[other.name] = single
    return list(best.values())
