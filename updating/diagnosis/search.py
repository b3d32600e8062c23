"""Which candidates are weighed: singles first, pairs when no single explains the data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import logsumexp

from acquisition.arrays import FloatArray
from updating.diagnosis.candidate import Candidate
from updating.diagnosis.evidence import Explanation, explain
from updating.diagnosis.fit import sensitivities
from updating.diagnosis.gaussian import whiten
from updating.diagnosis.goodness import p_value
from updating.diagnosis.problem import Problem
from updating.effects import Effect

REJECTED = 0.01
"""An explanation that fits worse than this is rejected."""

CLOSER_LOOKS = 3
"""How many explanations at most are weighed with more samples..."""

WORTH_A_CLOSER_LOOK = 0.03
"""...and from which probability on."""

PAIRS = 8
"""How many pairs are weighed, those a linear look finds the most promising."""

PAIR_PRIOR = 0.05
"""Prior weight of a pair against a single effect."""


@dataclass(frozen=True, eq=False)
class Weighed:
    """An explanation with its share of the probability and how well it fits."""

    explanation: Explanation
    probability: float
    p_value: float

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.explanation.names


@dataclass(frozen=True, eq=False)
class Search:
    """All that was weighed.

    Parameters
    ----------
    nothing : Explanation
        The nominal model with its tolerances.
    weighed : tuple of Weighed
        All sets of effects, most probable first; the empty set is among them.
    not_examined : dict
        Effects left out, and why.
    """

    nothing: Explanation
    weighed: tuple[Weighed, ...]
    not_examined: dict[str, str]


def examine(problem: Problem, library: Sequence[Effect]) -> tuple[list[Effect], dict[str, str]]:
    """Sort a library into what can be examined on this specimen and what cannot, with the reason."""
    obstacles = {effect.name: effect.why_not(problem.predictor) for effect in library}
    possible = [effect for effect in library if obstacles[effect.name] is None]
    return possible, {name: why for name, why in obstacles.items() if why is not None}


def search(problem: Problem, library: Sequence[Effect]) -> Search:
    """Weigh nothing, every single effect, and pairs if no single one fits.

    Parameters
    ----------
    problem : Problem
        Test and model.
    library : sequence of Effect
        Effects to consider.
    """
    effects, obstacles = examine(problem, library)
    nothing = explain(problem, Candidate())
    twin = _falls_short(problem, effects)
    singles: list[Explanation] = []
    for effect in effects:
        singles.append(_single(problem, effect, twin=twin, bar=_bar([nothing, *singles])))
    found = [nothing, *singles]
    if max(_fit(e) for e in found) < REJECTED:
        found += _pairs(problem, singles)
    rows = _weigh(found)
    closer = [_closer(problem, row) if i < CLOSER_LOOKS else row.explanation for i, row in enumerate(rows)]
    return Search(nothing, _weigh(closer), obstacles)


def _closer(problem: Problem, row: Weighed) -> Explanation:
    """Weigh what matters again with more samples, from where it was best."""
    explanation = row.explanation
    if row.probability < WORTH_A_CLOSER_LOOK or not explanation.samples.shape[1]:
        return explanation
    finer = explain(problem, explanation.candidate, starts=[explanation.best.coordinates], density=64)
    lost = explanation.log_evidence - finer.log_evidence
    return explanation if lost > 1.0 else finer  # it had more peaks than one


def _bar(found: list[Explanation]) -> float:
    """Return the best log-likelihood so far."""
    return max(e.best.marginal.log_likelihood for e in found)


def _fit(explanation: Explanation) -> float:
    return p_value(explanation.best, explanation.samples.shape[1])


def _weigh(found: list[Explanation]) -> tuple[Weighed, ...]:
    prior = np.array([PAIR_PRIOR if len(e.names) > 1 else 1.0 for e in found])
    score = np.array([e.log_evidence for e in found]) + np.log(prior)
    probability = np.exp(score - logsumexp(score))
    rows = [Weighed(e, float(p), _fit(e)) for e, p in zip(found, probability, strict=True)]
    return tuple(sorted(rows, key=lambda row: -row.probability))


def _falls_short(problem: Problem, effects: list[Effect]) -> bool:
    """Tell whether every effect must also be weighed on the better beam theory.

    It must where the theory shifts frequencies by more than a part of the noise, unless the better theory alone
    explains the data: then nothing else is needed beside it.
    """
    shear = next((effect for effect in effects if effect.name == "shear"), None)
    if shear is None or _fit(explain(problem, Candidate((shear,)))) >= REJECTED:
        return False
    count = len(problem.nominal.frequency) + 5
    here = problem.predictor.predict(count=count).frequency
    there = problem.predictor.under("timoshenko").predict(count=count).frequency
    within = here <= 1.001 * problem.nominal.frequency.max()
    noise = np.hypot(
        problem.measured.repeatability, np.min(problem.measured.frequency_sigma / problem.measured.frequency)
    )
    return bool(np.abs(np.log(there / here))[within].max() > 0.3 * noise)


def _single(problem: Problem, effect: Effect, *, twin: bool, bar: float) -> Explanation:
    """Weigh one effect; where the theory falls short, on either theory and half the evidence of each."""
    plain = explain(problem, Candidate((effect,)), bar=bar)
    if not twin or effect.name == "shear":
        return plain
    better = explain(problem, Candidate((effect,), theory="timoshenko"), bar=bar)
    total = float(np.logaddexp(plain.log_evidence, better.log_evidence) - np.log(2))
    chosen = max(plain, better, key=lambda e: e.log_evidence)
    return Explanation(chosen.candidate, total, chosen.best, chosen.samples, chosen.weights)


def _pairs(problem: Problem, singles: list[Explanation]) -> list[Explanation]:
    """Weigh the pairs that a linear look at every pair finds the most promising."""
    looks = []
    data = len(problem.measured.frequency) + len(problem.damping_known) + problem.measured.constants.size
    for first, second in combinations(singles, 2):
        if len(first.best.coordinates) + len(second.best.coordinates) >= data:
            continue  # as many parameters as data explain anything
        gain, starts = _linear_look(problem, first, second)
        looks.append((gain, first, second, starts))
    looks = [look for look in looks if np.isfinite(look[0])]
    looks.sort(key=lambda look: -look[0])
    found: list[Explanation] = []
    for _, first, second, starts in looks[:PAIRS]:
        bar = _bar([*singles, *found])
        found.append(explain(problem, _joined(first, second), starts=starts, bar=bar))
    return found


def _joined(first: Explanation, second: Explanation) -> Candidate:
    theory = first.candidate.theory or second.candidate.theory
    return Candidate(first.candidate.effects + second.candidate.effects, theory=theory)


def _linear_look(problem: Problem, first: Explanation, second: Explanation) -> tuple[float, list[FloatArray]]:
    """Return the log-likelihood that a linear step from either single's best would reach, and where to start."""
    reached, starts = [], []
    for leader, other in ((first, second), (second, first)):
        if not (leader.best.possible and other.best.possible):
            continue
        columns = [sensitivities(problem, leader.candidate, leader.best), _increment(problem, other)]
        normal, load = whiten(
            leader.best.comparison, np.nan_to_num(np.hstack(columns)), leader.best.marginal.scale
        )
        step = np.linalg.lstsq(normal, load, rcond=1e-10)[0]
        reached.append(leader.best.marginal.log_likelihood + 0.5 * float(load @ step))
    middle = [np.full(len(e.best.coordinates), 0.5) for e in (first, second)]
    a, b = first.best.coordinates, second.best.coordinates
    starts = [np.concatenate(s) for s in ((a, middle[1]), (middle[0], b), (a, b))]
    return max(reached, default=-np.inf), starts


def _increment(problem: Problem, explanation: Explanation) -> FloatArray:
    """Return what an effect at its best adds to the nominal prediction, and its sensitivities there."""
    plain = problem.compare(Candidate().state(problem.predictor, ()))
    whole = (plain.residual - explanation.best.comparison.residual)[:, None]
    return np.hstack([whole, sensitivities(problem, explanation.candidate, explanation.best)])
