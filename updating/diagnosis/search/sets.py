"""Sets of several causes: the pairs that score tests find promising, one cause twice, and a third beside a pair."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.fit import Point, evaluate, sensitivities
from updating.diagnosis.search.prior import log_prior
from updating.effects import Effect
from updating.likelihood.gaussian import normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import (
    CLIMBS,
    PAIRS_ANEW,
    PAIRS_WEIGHED,
    PLACES_TOGETHER,
    QUANTILE_SPREAD,
    SET_MARGIN,
    SHIFT_SPREAD,
    TRIPLES_WEIGHED,
)


def pairs_of(problem: DiagnosisProblem, found: list[Explanation], *, least: bool) -> list[Explanation]:
    """Weigh the pairs that a score test at every pair finds the most promising.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : list of Explanation
        No effect, and every single one.
    least : bool
        Whether the most promising are weighed in any case: no single effect explains the data. Else only those are
        whose score test comes near the best.
    """
    singles = [e for e in found if e.names]
    possible = [e for e in singles if e.best.possible]
    if len(possible) < 2:
        return []
    examined = len({e.names for e in singles})
    best = max(e.log_evidence + log_prior(len(e.names), examined) for e in found)
    volume = [e.best.marginal.log_likelihood - e.log_evidence for e in possible]  # what their parameters cost
    reached = _score_tests(problem, possible)
    data = len(problem.at(Candidate(), np.zeros(0)).residual)
    evaluations = []
    for i, j in combinations(range(len(possible)), 2):
        first, second = possible[i], possible[j]
        if first.names == second.names:
            if not (first.candidate.effects[0].repeats and first.candidate.chosen != second.candidate.chosen):
                continue
            second = _next(second)
        if len(first.best.coordinates) + len(second.best.coordinates) >= data:
            continue  # as many parameters as data explain anything
        weight = first.candidate.log_weight + second.candidate.log_weight
        likelihood = max(reached[i, j], reached[j, i])
        expected = likelihood - volume[i] - volume[j] + log_prior(2, examined)
        if least or expected > best - SET_MARGIN:
            evaluations.append((likelihood + weight, first, second))
    for likelihood, first, second in _twice(problem, possible):
        cost = next(v for v, e in zip(volume, possible, strict=True) if e.candidate is first.candidate)
        expected = likelihood - 2 * cost + log_prior(2, examined)
        if len(first.best.coordinates) * 2 < data and (least or expected > best - SET_MARGIN):
            evaluations.append((likelihood, first, second))
    evaluations = [evaluation for evaluation in evaluations if np.isfinite(evaluation[0])]
    if not evaluations:
        return []
    evaluations.sort(key=lambda evaluation: -evaluation[0])
    chosen: dict[tuple[str, ...], tuple[Explanation, Explanation]] = {}
    for _, first, second in evaluations:  # of every two effects, the most promising forms
        chosen.setdefault(tuple(sorted(first.names + second.names)), (first, second))
    pairs: list[Explanation] = []
    bar = max(e.best.marginal.log_likelihood for e in possible)
    for first, second in list(chosen.values())[:PAIRS_WEIGHED]:
        pair_parts = [(e.candidate, e.best.coordinates) for e in (first, second)]
        pairs.append(_pair(problem, pair_parts[0], pair_parts[1], bar))
        bar = max(bar, pairs[-1].best.marginal.log_likelihood)
    pairs.sort(key=lambda e: -e.log_evidence)
    for i, pair in enumerate(pairs[:PAIRS_ANEW]):
        again = _pair(problem, *_parts_of_pair(problem, pair), bar, anew=True)
        pairs[i] = max(pair, again, key=lambda e: e.log_evidence)
        bar = max(bar, pairs[i].best.marginal.log_likelihood)
    return pairs + _alike(problem, possible, pairs, bar)


def _next(single: Explanation) -> Explanation:
    """Return a single effect as the second of its kind."""
    again = replace(single.candidate, effects=tuple(effect.again() for effect in single.candidate.effects))
    return replace(single, candidate=again)


def _twice(
    problem: DiagnosisProblem, singles: list[Explanation]
) -> list[tuple[float, Explanation, Explanation]]:
    """Return, for every effect that may occur twice, the two starting places that promise the most together.

    Returns
    -------
    list of (float, Explanation, Explanation)
        The log-likelihood that the two would reach, and the two at their starting places, not fitted.
    """
    found = []
    best = {single.names: single for single in sorted(singles, key=lambda one: one.log_evidence)}
    for single in best.values():
        if single.candidate.effects[0].repeats and not single.candidate.chosen[0].values:
            second = _next(single)
            reached, places = _places_together(problem, single.candidate, second.candidate)[0]
            count = len(single.best.coordinates)
            first = replace(single, best=evaluate(problem, single.candidate, places[:count]))
            found.append(
                (reached, first, replace(second, best=replace(first.best, coordinates=places[count:])))
            )
    return found


def _places_together(
    problem: DiagnosisProblem, one: Candidate, two: Candidate
) -> list[tuple[float, FloatArray]]:
    """Return starting places of two effects that explain the most together, best first.

    What either does from each of its starts is taken once; the two are added up, each as large as the data ask for.

    Returns
    -------
    list of (float, array)
        The log-likelihood that would be reached, and the prior quantiles of both.
    """
    nominal = evaluate(problem, Candidate(), np.zeros(0))
    own = [problem.starts(one), problem.starts(two)]
    first = [_reach(problem, one, place, nominal) for place in own[0]]
    second = first if one.names == two.names else [_reach(problem, two, place, nominal) for place in own[1]]
    widths = [part.shape[1] for part in (*first, *second)]
    ends = np.cumsum([0, *widths])
    normal, load = normal_equations(nominal.comparison, np.hstack([*first, *second]), nominal.marginal.scale)
    normal += np.eye(len(load))
    found = []
    for i in range(len(first)):
        for j in range(i + 1 if second is first else 0, len(second)):
            k = len(first) + j
            columns = np.r_[ends[i] : ends[i + 1], ends[k] : ends[k + 1]]
            gain = 0.5 * float(
                load[columns] @ np.linalg.solve(normal[np.ix_(columns, columns)], load[columns])
            )
            found.append((nominal.marginal.log_likelihood + gain, np.concatenate([own[0][i], own[1][j]])))
    found.sort(key=lambda pair: -pair[0])
    return found[:PLACES_TOGETHER]


def _reach(problem: DiagnosisProblem, candidate: Candidate, place: FloatArray, nominal: Point) -> FloatArray:
    """Return what an effect does about a starting place, (n, 1 + k): its whole shift, and per parameter.

    The columns are as wide as they are believed to be needed: some times the shift, the spread of a prior quantile.
    """
    point = evaluate(problem, candidate, place)
    if not point.possible:
        return np.zeros((len(nominal.comparison.residual), 1 + len(place)))
    shift = nominal.comparison.residual - point.comparison.residual
    own = sensitivities(problem, candidate, point)
    return np.nan_to_num(np.column_stack([SHIFT_SPREAD * shift, QUANTILE_SPREAD * own]))


def triples_of(problem: DiagnosisProblem, found: list[Explanation]) -> list[Explanation]:
    """Add to the best pair, one at a time, the single effects that a score test finds the most promising."""
    pairs = [e for e in found if len(e.names) == 2 and e.best.possible]
    best = max(pairs, key=lambda e: e.log_evidence, default=None)
    if best is None:
        return []
    data = len(best.best.comparison.residual)
    others = [
        e
        for e in found
        if len(e.names) == 1
        and e.best.possible
        and e.names[0] not in best.names
        and len(best.best.coordinates) + len(e.best.coordinates) < data - 1
    ]
    if not others:
        return []
    reached = _score_tests(problem, [best, *others])[0, 1:]
    weight = np.array([e.candidate.log_weight for e in others])
    chosen: dict[tuple[str, ...], Explanation] = {}
    for i in np.argsort(-(reached + weight)):
        chosen.setdefault(others[i].names, others[i])
    bar, triples = best.best.marginal.log_likelihood, []
    whole = (best.candidate, best.best.coordinates)
    for other in list(chosen.values())[:TRIPLES_WEIGHED]:
        triples.append(_pair(problem, whole, (other.candidate, other.best.coordinates), bar))
        bar = max(bar, triples[-1].best.marginal.log_likelihood)
    return triples


PairPart = tuple[Candidate, FloatArray]
"""One of the two effects of a pair, and prior quantiles to start from."""


def _pair(
    problem: DiagnosisProblem, first: PairPart, second: PairPart, bar: float, *, anew: bool = False
) -> Explanation:
    """Draft a pair, from the best that each of the two has alone, and where asked from all its own starts anew.

    An effect that explains as much as it can alone bends to what the other does, so that its place alone may be far
    from that in the pair.
    """
    (one, a), (two, b) = first, second
    middle = [np.full(len(u), 0.5) for u in (a, b)]
    starts = [np.concatenate(s) for s in ((a, middle[1]), (middle[0], b), (a, b))]
    if anew:
        starts += [np.concatenate([a, own]) for own in problem.starts(two)]
        starts += [np.concatenate([own, b]) for own in problem.starts(one)]
        starts += [places for _, places in _places_together(problem, one, two)]
    both = Candidate(one.effects + two.effects, fuller=one.fuller or two.fuller, chosen=one.forms + two.forms)
    unlike = list(
        {tuple(u.tolist()): u for u in starts}.values()
    )  # of an effect without parameters all are alike
    return explain(
        problem, both, starts=unlike, laplace_only=True, maximisations=CLIMBS if anew else 1, bar=bar
    )


def _alike(
    problem: DiagnosisProblem, singles: list[Explanation], pairs: list[Explanation], bar: float
) -> list[Explanation]:
    """Draft what some data cannot tell from the best pair: one of the two in the place of an effect like it.

    Such a rival may fit as well where it alone, at another place, fits too badly for the score test to choose it.
    """
    best = max(pairs, key=lambda e: e.log_evidence, default=None)
    if best is None:
        return []
    known, found = {tuple(sorted(e.names)) for e in pairs}, []
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
                    _pair(problem, (kept, place), (rival.candidate, rival.best.coordinates), bar, anew=True)
                )
    return found


def _parts_of_pair(problem: DiagnosisProblem, pair: Explanation) -> tuple[PairPart, PairPart]:
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


def _score_tests(problem: DiagnosisProblem, singles: list[Explanation]) -> FloatArray:
    """Return the log-likelihood that a linear step from each single's best, with each other, would reach.

    Returns
    -------
    (n, n) array
        Row: whose best is the start; column: whose whole shift, and its sensitivities there, are added [-].
    """
    nominal = problem.at(Candidate(), np.zeros(0)).residual
    own = [np.nan_to_num(sensitivities(problem, e.candidate, e.best)) for e in singles]
    shifts = [(nominal - e.best.comparison.residual)[:, None] for e in singles]
    everything = np.nan_to_num(np.hstack([np.hstack(pair) for pair in zip(shifts, own, strict=True)]))
    ends = np.cumsum([0, *(1 + part.shape[1] for part in own)])
    reached = np.full((len(singles), len(singles)), -np.inf)
    for i, leader in enumerate(singles):
        normal, load = normal_equations(leader.best.comparison, everything, leader.best.marginal.scale)
        start = leader.best.marginal.log_likelihood
        mine = np.arange(ends[i] + 1, ends[i + 1])
        for j in range(len(singles)):
            if j != i:
                columns = np.concatenate([mine, np.arange(ends[j], ends[j + 1])])
                step = np.linalg.lstsq(normal[np.ix_(columns, columns)], load[columns], rcond=1e-10)[0]
                reached[i, j] = start + 0.5 * float(load[columns] @ step)
    return reached
