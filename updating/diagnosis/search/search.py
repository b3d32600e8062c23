"""Which candidates are weighed: singles first, pairs where no single explains the data well, then triples.

An effect may come in several forms (which point, which sign); each is weighed by itself, with its share of the
effect's prior, and their evidence is added up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb

import numpy as np
from scipy.special import logsumexp

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain, finish
from updating.diagnosis.search.fit import sensitivities
from updating.effects import Effect, Lack, Obstacle, Variant
from updating.likelihood.gaussian import normal_equations
from updating.problem.candidate import Candidate
from updating.problem.theory_error import theory_shows
from updating.thresholds import (
    CLIMBS,
    COUNT_PRIOR,
    DOUBTED_FIT,
    FINISHING_ROUNDS,
    FORM_SHARE,
    HELD_NEAR_END,
    HELD_SHARE,
    NEGLIGIBLE_PROBABILITY,
    PAIRS_ANEW,
    PAIRS_WEIGHED,
    PROBABLE_BEHIND,
    REJECTED_FIT,
    SET_MARGIN,
    TRIPLES_WEIGHED,
    WELL_FITTED,
    WITHIN_REACH,
)

BENEATH = "what it changes of a plate is computed, and put under every set of causes where it shows"
"""Why a plate's theory is not weighed as a cause."""


@dataclass(frozen=True, eq=False)
class Compared:
    """An explanation with its share of the probability and how well it fits.

    Parameters
    ----------
    explanation : Explanation
        What was weighed.
    probability : float
        Its share [-].
    p_value : float
        How well it fits [-].
    extreme : tuple of str
        Parameters that the data push to an end of their range that is no natural one.
    """

    explanation: Explanation
    probability: float
    p_value: float
    extreme: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.explanation.names

    @property
    def rejected(self) -> bool:
        """Whether it is no answer: it fits too badly (pairs, which have more freedom, must fit better), or only at a
        size beyond what is plausible.
        """
        return bool(self.extreme) or self.p_value < (DOUBTED_FIT if len(self.names) > 1 else REJECTED_FIT)


@dataclass(frozen=True, eq=False)
class Search:
    """All that was weighed.

    Parameters
    ----------
    nothing : Explanation
        The nominal model with its tolerances.
    compared : tuple of Weighed
        All sets of effects, most probable first; the empty set is among them.
    not_examined : dict
        Effects left out, and why.
    both : bool
        Whether every set was weighed on the model's theory and on the fuller one.
    """

    nothing: Explanation
    compared: tuple[Compared, ...]
    not_examined: dict[str, Obstacle]
    both: bool = False


def examine(problem: DiagnosisProblem, library: Sequence[Effect]) -> tuple[list[Effect], dict[str, Obstacle]]:
    """Sort a library into what can be examined on this specimen and what cannot, with the reason."""
    obstacles = {effect.name: problem.applies(effect) for effect in library}
    for effect in library:
        if effect.fuller and obstacles[effect.name] is None and _beneath(problem):
            obstacles[effect.name] = Obstacle(Lack.MODEL, BENEATH)
    possible = [effect for effect in library if obstacles[effect.name] is None]
    return possible, {name: why for name, why in obstacles.items() if why is not None}


def search(problem: DiagnosisProblem, library: Sequence[Effect]) -> Search:
    """Weigh nothing, every single effect, and pairs if no single one fits.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    library : sequence of Effect
        Effects to consider.
    """
    effects, obstacles = examine(problem, library)
    nothing = explain(problem, Candidate())
    both = _on_both(problem, effects, nothing)
    if both and _beneath(problem):
        nothing = _either(nothing, explain(problem, Candidate(fuller=True)))
    drafts = _singles(problem, effects, nothing, both=both)
    found = _finished(problem, [nothing, *drafts])
    if not _explained(problem, found, well=True):
        found = _finished(problem, found + _pairs(problem, found, least=not _explained(problem, found)))
    if not _explained(problem, found):
        found = _finished(problem, found + _triples(problem, found))
    return Search(nothing, _merged(problem, _compare(found)), obstacles, both)


def _explained(problem: DiagnosisProblem, found: list[Explanation], *, well: bool = False) -> bool:
    """Tell whether any of the probable explanations fits beyond doubt, and at a plausible size.

    Where it has to fit well, its fit is no rarer than one in ten.
    """
    least = WELL_FITTED if well else DOUBTED_FIT
    rows = _compare(found)
    top = max(row.probability for row in rows)
    near = [row for row in rows if row.probability > top * np.exp(-PROBABLE_BEHIND)]
    return any(row.p_value >= least and not _extreme(problem, row.explanation) for row in near)


def _finished(problem: DiagnosisProblem, found: list[Explanation]) -> list[Explanation]:
    """Weigh by predictions what drafts left within reach of the best; the rest stays as drafted."""
    finished = list(found)
    for evaluation in range(FINISHING_ROUNDS):
        rows = _compare(finished)
        bar = max(row.probability for row in rows) * np.exp(-WITHIN_REACH)
        left = [i for i, row in enumerate(rows) if row.explanation.laplace_only and row.probability > bar]
        if not left:
            break
        left.sort(key=lambda i: -rows[i].probability)
        for i in left if evaluation else left[:1]:  # the best first: it may put the others out of reach
            finished[i] = finish(problem, finished[i])
    return finished


def _merged(problem: DiagnosisProblem, rows: Sequence[Compared]) -> tuple[Compared, ...]:
    """Add up the forms of each set of effects; the most probable form stands for them."""
    forms: dict[frozenset[str], list[Compared]] = {}
    for row in rows:
        forms.setdefault(frozenset(row.names), []).append(row)
    merged = []
    for own in forms.values():
        top = max(own, key=lambda row: row.probability)
        total = float(logsumexp([row.explanation.log_evidence for row in own]))
        fits = max(row.p_value for row in own if row.probability >= FORM_SHARE * top.probability)
        probability = sum(row.probability for row in own)
        extreme = _extreme(problem, top.explanation) if probability > NEGLIGIBLE_PROBABILITY else ()
        merged.append(Compared(replace(top.explanation, log_evidence=total), probability, fits, extreme))
    return tuple(sorted(merged, key=lambda row: -row.probability))


def _extreme(problem: DiagnosisProblem, explanation: Explanation) -> tuple[str, ...]:
    """Return the parameters whose best value and most of whose posterior lie at an end that is a judgement."""
    found = []
    for i, (name, parameter) in enumerate(problem.parameters(explanation.candidate)):
        best = float(explanation.best.coordinates[i])
        away = np.abs(explanation.samples[:, i] - round(best))
        if parameter.extreme(best) and explanation.weights[away > HELD_NEAR_END].sum() < 1 - HELD_SHARE:
            found.append(name)
    return tuple(found)


def log_prior(causes: int, examined: int) -> float:
    """Return the logarithm of the prior of one set of so many causes, among so many effects examined [-]."""
    return float(np.log(COUNT_PRIOR[causes] / comb(max(examined, causes), causes)))


def _compare(found: list[Explanation]) -> list[Compared]:
    examined = len({name for e in found for name in e.names})
    score = np.array([e.log_evidence + log_prior(len(e.names), examined) for e in found])
    probability = np.exp(score - logsumexp(score))
    return [Compared(e, float(p), e.p_value) for e, p in zip(found, probability, strict=True)]


def _beneath(problem: DiagnosisProblem) -> bool:
    """Tell whether theory is no cause to be named but what every set, the empty one too, stands on: of plates.

    What a thin plate lacks is computed mode by mode; nobody who models one means that the specimen has no shear.
    """
    return all(one.predictor.spec.kind == "plate" for one in problem.specimens)


def _on_both(problem: DiagnosisProblem, effects: list[Effect], nothing: Explanation) -> bool:
    """Tell whether every set must be weighed on the fuller theory as well.

    It must where that theory moves frequencies or shapes by more than a part of the noise, unless, where theory is a
    cause like others, it alone explains the data: then nothing else is needed beside it.
    """
    if not any(theory_shows(one) for one in problem.specimens):
        return False
    if _beneath(problem):
        return True
    fuller = next((effect for effect in effects if effect.fuller), None)
    return fuller is not None and explain(problem, Candidate((fuller,))).p_value < REJECTED_FIT


def _singles(
    problem: DiagnosisProblem, effects: list[Effect], nothing: Explanation, *, both: bool
) -> list[Explanation]:
    """Weigh every form of every effect, the simple ones first: what they reach is the bar for the others."""
    forms = [(effect, form) for effect in effects for form in problem.forms(effect)]
    forms.sort(key=lambda pair: len(problem.parameters(Candidate((pair[0],), chosen=(pair[1],)))))
    bar, found = nothing.best.marginal.log_likelihood, []
    for effect, form in forms:
        found.append(_single(problem, effect, form, bar, both=both))
        bar = max(bar, found[-1].best.marginal.log_likelihood)
    return found


def _single(
    problem: DiagnosisProblem, effect: Effect, form: Variant, bar: float, *, both: bool
) -> Explanation:
    """Weigh one form of an effect, where the theory falls short on either theory."""
    plain = explain(problem, Candidate((effect,), chosen=(form,)), laplace_only=True, bar=bar)
    if not both or effect.fuller:
        return plain
    fuller = Candidate((effect,), fuller=True, chosen=(form,))
    return _either(plain, explain(problem, fuller, laplace_only=True, bar=bar))


def _either(plain: Explanation, fuller: Explanation) -> Explanation:
    """Return the better of one set on two theories, with half the evidence of each."""
    total = float(np.logaddexp(plain.log_evidence, fuller.log_evidence) - np.log(2))
    chosen = max(plain, fuller, key=lambda e: e.log_evidence)
    return replace(chosen, log_evidence=total, other=total - chosen.log_evidence)


def _pairs(problem: DiagnosisProblem, found: list[Explanation], *, least: bool) -> list[Explanation]:
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
            continue
        if len(first.best.coordinates) + len(second.best.coordinates) >= data:
            continue  # as many parameters as data explain anything
        weight = first.candidate.log_weight + second.candidate.log_weight
        likelihood = max(reached[i, j], reached[j, i])
        expected = likelihood - volume[i] - volume[j] + log_prior(2, examined)
        if least or expected > best - SET_MARGIN:
            evaluations.append((likelihood + weight, first, second))
    evaluations = [evaluation for evaluation in evaluations if np.isfinite(evaluation[0])]
    if not evaluations:
        return []
    evaluations.sort(key=lambda evaluation: -evaluation[0])
    chosen: dict[frozenset[str], tuple[Explanation, Explanation]] = {}
    for _, first, second in evaluations:  # of every two effects, the most promising forms
        chosen.setdefault(frozenset(first.names + second.names), (first, second))
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


def _triples(problem: DiagnosisProblem, found: list[Explanation]) -> list[Explanation]:
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
    known, found = {frozenset(e.names) for e in pairs}, []
    data = len(best.best.comparison.residual)
    pair_parts = _parts_of_pair(problem, best)
    for (kept, place), (other, _) in (pair_parts, pair_parts[::-1]):
        for rival in _like(other.effects[0], singles):
            names = frozenset(kept.names + rival.names)
            if len(names) == 2 and names not in known and len(place) + len(rival.best.coordinates) < data:
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
