"""Sets of several causes: the pairs that score tests find promising, one cause twice, and a third beside a pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations_with_replacement, product, zip_longest

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.fit import Point, evaluate, highest, sensitivities
from updating.diagnosis.search.prior import log_prior
from updating.effects import Effect
from updating.likelihood.gaussian import normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import (
    CLIMBS,
    FORMS_TRIED,
    PAIRS_ANEW,
    PAIRS_WEIGHED,
    PLACES_TOGETHER,
    QUANTILE_SPREAD,
    SET_MARGIN,
    SHIFT_SPREAD,
    STEP_INSIDE,
    STEPS_TRIED,
    TRIPLES_WEIGHED,
)


def pairs_of(problem: DiagnosisProblem, found: list[Explanation], *, least: bool) -> list[Explanation]:
    """Weigh the pairs that promise the most, from the best of either effect alone and from no effect at all.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : list of Explanation
        No effect, and every single one.
    least : bool
        Whether the most promising are weighed in any case: no single effect explains the data. Else only those are
        that promise to come near the best.
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
    reached = _score_tests(problem, possible)
    reaches = [_reaches(problem, nominal, e.candidate) for e in possible]
    drafts = []
    for (i, j), together in zip(allowed, _together(nominal, reaches, allowed), strict=True):
        first, second = possible[i], possible[j]
        second = _next(second) if first.names == second.names else second
        cost = log_prior(2, examined) - volume[i] - volume[j]
        near = max(reached[i, j], reached[j, i]) if i != j else -np.inf
        far = together[0][0] if together else -np.inf
        if least or max(near, far) + cost > best - SET_MARGIN:
            drafts.append(_Draft(first, second, near + cost, far + cost, [u for _, u in together]))
    pairs: list[tuple[Explanation, list[FloatArray]]] = []
    bar = max(e.best.marginal.log_likelihood for e in possible)
    chosen = _promising(drafts)
    if not all(one.predictor.spec.outlined for one in problem.specimens):
        chosen = _best_forms(problem, chosen, drafts)
    for draft in chosen:
        parts = [(e.candidate, e.best.coordinates) for e in (draft.first, draft.second)]
        pair = _pair(problem, parts[0], parts[1], bar, places=draft.places)
        pairs.append((pair, draft.places))
        bar = max(bar, pair.best.marginal.log_likelihood)
    pairs.sort(key=lambda own: -own[0].log_evidence)
    best_of = [pair for pair, _ in pairs]
    for i, (pair, places) in enumerate(pairs[:PAIRS_ANEW]):
        again = _pair(problem, *_parts_of_pair(problem, pair), bar, anew=True, places=places)
        best_of[i] = max(pair, again, key=lambda e: e.log_evidence)
        bar = max(bar, best_of[i].best.marginal.log_likelihood)
    return best_of + _alike(problem, possible, best_of, bar)


@dataclass(frozen=True, eq=False)
class _Draft:
    """A pair that may be weighed.

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
    """Return the same pairs of effects in the forms that a short climb finds best.

    On imported matrices every place is a form of its own, and a linear step errs by more than two neighbours differ.
    """
    found: dict[tuple[str, ...], list[_Draft]] = {}
    for names in dict.fromkeys(draft.names for draft in chosen):
        own = [draft for draft in drafts if draft.names == names]
        near = sorted((d for d in own if np.isfinite(d.near)), key=lambda draft: -draft.near)[:FORMS_TRIED]
        far = sorted((d for d in own if np.isfinite(d.far)), key=lambda draft: -draft.far)[:FORMS_TRIED]
        tried = list(dict.fromkeys([*near, *far]))
        found[names] = sorted(tried, key=lambda draft: -_climbed(problem, draft)) if len(tried) > 1 else tried
    taken = dict.fromkeys(found, 0)
    best = []
    for draft in chosen:
        best.append(found[draft.names][taken[draft.names]])
        taken[draft.names] += 1
    return best


def _climbed(problem: DiagnosisProblem, draft: _Draft) -> float:
    """Return the log-likelihood, with the forms' shares of the prior, that a pair reaches in a few steps."""
    (one, a), (two, b) = ((e.candidate, e.best.coordinates) for e in (draft.first, draft.second))
    both = Candidate(one.effects + two.effects, fuller=one.fuller or two.fuller, chosen=one.forms + two.forms)
    starts = [np.concatenate([a, b]), *draft.places[:1]]
    reached = [highest(problem, both, start, rounds=STEPS_TRIED).marginal.log_likelihood for start in starts]
    return max(reached) + both.log_weight


def _allowed(problem: DiagnosisProblem, singles: list[Explanation]) -> list[tuple[int, int]]:
    """Return which two may be causes together: not one effect twice but at two places, and fewer parameters than data.

    As many parameters as data explain anything.
    """
    allowed = []
    data = len(singles[0].best.comparison.residual)
    for i, j in combinations_with_replacement(range(len(singles)), 2):
        first, second = singles[i], singles[j]
        if first.names == second.names:
            placed = any(name.endswith(".x") for name, _ in problem.parameters(first.candidate))
            if not first.candidate.effects[0].repeats or (i == j and not placed):
                continue
        if len(first.best.coordinates) + len(second.best.coordinates) < data:
            allowed.append((i, j))
    return allowed


def _next(single: Explanation) -> Explanation:
    """Return a single effect as the second of its kind."""
    again = replace(single.candidate, effects=tuple(effect.again() for effect in single.candidate.effects))
    return replace(single, candidate=again)


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
    points = [evaluate(problem, candidate, place) for place in problem.starts(candidate)]
    return [
        _Reach(
            point.coordinates,
            np.nan_to_num(
                np.column_stack(
                    [
                        SHIFT_SPREAD * (nominal.comparison.residual - point.comparison.residual),
                        QUANTILE_SPREAD * sensitivities(problem, candidate, point),
                    ]
                )
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
        step = QUANTILE_SPREAD * np.linalg.solve(normal[np.ix_(free, free)], left)
        return np.clip(np.concatenate([flat[a].place, flat[b].place]) + step, *STEP_INSIDE)

    found = []
    for i, j in pairs:
        own: list[tuple[float, tuple[int, int]]] = []
        for a, b in product(range(starts[i], starts[i + 1]), range(starts[j], starts[j + 1])):
            if i == j and a >= b:
                continue
            columns = np.r_[ends[a] : ends[a + 1], ends[b] : ends[b + 1]]
            step = np.linalg.solve(normal[np.ix_(columns, columns)], load[columns])
            reached = nominal.marginal.log_likelihood + 0.5 * float(load[columns] @ step)
            own.append((reached, (a, b)))
        own.sort(key=lambda one: -one[0])
        found.append([(reached, one_step(a, b)) for reached, (a, b) in own[:PLACES_TOGETHER]])
    return found


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
    problem: DiagnosisProblem,
    first: PairPart,
    second: PairPart,
    bar: float,
    *,
    anew: bool = False,
    places: Sequence[FloatArray] = (),
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
    starts += places
    both = Candidate(one.effects + two.effects, fuller=one.fuller or two.fuller, chosen=one.forms + two.forms)
    unlike = list(
        {tuple(u.tolist()): u for u in starts}.values()
    )  # of an effect without parameters all are alike
    count = CLIMBS if anew else 1 + bool(places)
    return explain(problem, both, starts=unlike, laplace_only=True, maximisations=count, bar=bar)


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
