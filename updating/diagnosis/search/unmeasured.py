"""Which of a model's modes a test without shapes has not measured.

Without shapes the measured modes pair with the model's by rank. A mode that the test lacks, because a sensor or the
hammer stood on its node, shifts all ranks above it, and then nothing fits: neither the truth nor anything else. So
where nothing that was compared fits, every single effect is tried with modes of the model left out. The ranks follow
from the pattern of the frequencies, by dynamic programming (Needleman and Wunsch 1970, Journal of Molecular Biology 48,
443-453): measured modes keep their order, and each mode of the model that is left out has a price. The evidence
decides between the ranks, as it does between causes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import qmc

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import hertz
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.prior import log_prior
from updating.diagnosis.search.search import examine
from updating.effects import Effect
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem
from updating.problem.theory_error import theory_error
from updating.thresholds import DOUBTED_FIT


@dataclass(frozen=True)
class Pattern:
    """How patterns of frequencies are compared.

    Parameters
    ----------
    missed : float
        Prior of each mode of the model in the band to be missing in the test [-].
    spread : float
        Standard deviation of ln f of a sample of an effect's parameters from the best ones [-].
    common : tuple of float
        What all ln f may have in common beside the effect [-].
    samples, most : int
        Samples of one parameter of an effect, twice as many with each further one, and at most.
    tried : int
        From so many patterns, the most probable ones of different ranks, parameters are fitted.
    rounds : int
        How often ranks are found anew beside fitted parameters.
    """

    missed: float = 0.1
    spread: float = 0.03
    common: tuple[float, ...] = (-0.1, -0.05, 0.0, 0.05, 0.1)
    samples: int = 64
    most: int = 256
    tried: int = 6
    rounds: int = 3

    @property
    def price(self) -> float:
        """Logarithm of the odds against one missing mode [-]."""
        return float(np.log((1 - self.missed) / self.missed))


@dataclass(frozen=True, eq=False)
class _Trial:
    """Ranks of the measured modes, with a candidate and the parameters at which these are probable."""

    cost: float
    order: IntArray
    candidate: Candidate
    place: FloatArray


def with_unmeasured_modes(
    problem: DiagnosisProblem, found: Search, library: Sequence[Effect], *, pattern: Pattern = Pattern()
) -> tuple[SpecimenProblem, str] | None:
    """Return the problem with modes of the model that the test lacks, and which; None where the ranks stand.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model. Nothing is tried with shapes, beside a baseline, where pairs are stated, of several specimens.
    found : Search
        What was compared with the ranks as they are.
    library : sequence of Effect
        Effects to consider.
    pattern : Pattern
        How patterns are compared.
    """
    if (
        not isinstance(problem, SpecimenProblem)
        or problem.measured.has_shapes
        or problem.baseline is not None
    ):
        return None
    if problem.measured.partners is not None or fits(found):
        return None
    effects = examine(problem, library)[0]
    level = max(
        row.explanation.log_evidence + log_prior(len(row.names), len(effects)) for row in found.compared
    )
    best, order = level, problem.order
    for trial in _most_probable(problem, effects, pattern):
        score, ranks = _fitted(problem, trial, len(effects), pattern)
        if score > best:
            best, order = score, ranks
    return None if order is problem.order else (_ranked(problem, order), _note(problem, order))


def fits(found: Search) -> bool:
    """Return whether the most probable explanation fits, no data set aside."""
    return found.compared[0].as_stated >= DOUBTED_FIT


def ranks(
    measured: FloatArray, predicted: FloatArray, *, price: float, spread: float, below: int = 0
) -> tuple[IntArray, FloatArray]:
    """Return the most probable ranks of measured modes among predicted ones, in order, and minus their logarithm.

    Parameters
    ----------
    measured : (n,) array
        Logarithms of frequencies, rising [-].
    predicted : (s, m) array
        Those of s models, rising; not finite where there are fewer [-].
    price : float
        Logarithm of the odds against one missing mode [-].
    spread : float
        Standard deviation of each difference [-].
    below : int
        Modes of the model below the first that the test might have.

    Returns
    -------
    order : (s, n) int array
    cost : (s,) array
        Infinite where the model has too few modes.
    """
    count, modes = len(measured), predicted.shape[1]
    off = np.nan_to_num(
        (measured[:, None] - predicted[:, None]) / spread, nan=np.inf, posinf=np.inf, neginf=np.inf
    )
    each = 0.5 * off**2
    passed = price * (np.arange(modes) - below).astype(float)
    passed[:below] = np.inf
    total = each[:, 0] + passed
    before = np.zeros((count, len(predicted), modes), dtype=np.int64)
    for i in range(1, count):
        reached = np.full(total.shape, np.inf)
        for j in range(1, modes):
            skipped, direct = reached[:, j - 1] + price, total[:, j - 1]
            near = direct <= skipped
            reached[:, j] = np.where(near, direct, skipped)
            before[i, :, j] = np.where(near, j - 1, before[i, :, j - 1])
        total = reached + each[:, i]
    order = np.empty((len(predicted), count), dtype=np.int64)
    order[:, -1] = np.argmin(total, axis=1)
    rows = np.arange(len(predicted))
    for i in range(count - 1, 0, -1):
        order[:, i - 1] = before[i, rows, order[:, i]]
    return order, total[rows, order[:, -1]]


def _most_probable(problem: SpecimenProblem, effects: Sequence[Effect], pattern: Pattern) -> list[_Trial]:
    """Return the most probable patterns of all single effects, and of none, that leave modes out."""
    candidates = [Candidate()]
    candidates += [Candidate((one,), chosen=(form,)) for one in effects for form in problem.forms(one)]
    found: dict[tuple[int, ...], _Trial] = {}
    for candidate in candidates:
        best = _sampled(problem, candidate, pattern)
        for trial in best:
            key = tuple(trial.order.tolist())
            if (trial.order != problem.order).any() and (key not in found or trial.cost < found[key].cost):
                found[key] = trial
    return sorted(found.values(), key=lambda trial: trial.cost)[: pattern.tried]


def _sampled(problem: SpecimenProblem, candidate: Candidate, pattern: Pattern) -> list[_Trial]:
    """Return the most probable ranks at samples of a candidate's parameters, the best few."""
    size = len(problem.parameters(candidate))
    count = min(pattern.samples * 2 ** max(size - 1, 0), pattern.most)
    places = qmc.Sobol(size, seed=1).random(count) if size else np.zeros((1, 0))
    predicted = _predicted(problem, candidate, places)
    shifts = np.array(pattern.common)
    spread_out = (predicted[:, None] + shifts[:, None]).reshape(-1, predicted.shape[1])
    order, cost = _ranks_of(problem, spread_out, pattern, pattern.spread)
    top = np.argsort(cost, kind="stable")[: pattern.tried]
    return [
        _Trial(float(cost[i]), order[i], candidate, places[i // len(shifts)])
        for i in top.tolist()
        if np.isfinite(cost[i])
    ]


def _predicted(problem: SpecimenProblem, candidate: Candidate, places: FloatArray) -> FloatArray:
    """Return ln f of the model at some parameters, (s, m), nan where a model has fewer modes [-].

    So many are compared that a test may lack as many as it has.
    """
    count = len(problem.measured.frequency)
    most = problem.measured.below + 2 * count
    found = []
    for place in places:
        (state,) = problem.place(candidate, place)
        frequency = problem.predictor.predict(state, at_least=most).frequency
        found.append(np.log(np.sort(frequency)[:most]))
    whole = np.full((len(found), max(len(one) for one in found)), np.nan)
    for row, one in zip(whole, found, strict=True):
        row[: len(one)] = one
    return whole


def _ranks_of(
    problem: SpecimenProblem, predicted: FloatArray, pattern: Pattern, spread: float
) -> tuple[IntArray, FloatArray]:
    measured = np.log(problem.measured.frequency)
    return ranks(measured, predicted, price=pattern.price, spread=spread, below=problem.measured.below)


def _fitted(
    problem: SpecimenProblem, trial: _Trial, examined: int, pattern: Pattern
) -> tuple[float, IntArray]:
    """Return the score of a candidate at the best of its ranks, these found anew where its parameters have moved."""
    test = problem.measured
    noise = float(np.sqrt(np.mean((test.frequency_sigma / test.frequency) ** 2 + test.repeatability**2)))
    best, kept = -np.inf, trial.order
    order, place, done = trial.order, trial.place, set[tuple[int, ...]]()
    for once in range(pattern.rounds):
        done.add(tuple(order.tolist()))
        one = explain(_ranked(problem, order), trial.candidate, starts=[place], laplace_only=True)
        skipped = int(order[-1] - test.below + 1 - len(order))
        prior = log_prior(len(one.names), examined) - pattern.price * skipped
        if one.log_evidence + prior > best:
            best, kept = one.log_evidence + prior, order
        place = one.best.coordinates
        here = _predicted(problem, trial.candidate, place[None, :])
        # closer from round to round: what is left of a misfit is in doubt until the ranks are right
        spread = max(noise, pattern.spread / 2.0 ** (once + 1))
        order = _ranks_of(problem, here, pattern, spread)[0][0]
        if tuple(order.tolist()) in done:
            break
    return best, kept


def _ranked(problem: SpecimenProblem, order: IntArray) -> SpecimenProblem:
    return replace(problem, order=order, theory_error=theory_error(problem.predictor, order))


def _note(problem: SpecimenProblem, order: IntArray) -> str:
    """State which modes of the model are taken to be missing in the test, and between which of its modes each is."""
    test, missing = problem.measured, np.setdiff1d(np.arange(problem.measured.below, order[-1]), order)
    between = []
    for rank in missing.tolist():
        above = int(np.searchsorted(order, rank))
        where = f"below {hertz(test.frequency[above])}"
        between.append(
            where
            if above == 0
            else f"between {hertz(test.frequency[above - 1])} and {hertz(test.frequency[above])}"
        )
    counts = {where: between.count(where) for where in dict.fromkeys(between)}
    stated = "; ".join(f"{number} {where}" for where, number in counts.items())
    return (
        f"the frequencies fit only if the test lacks modes of the model: {stated}. Hit and measure at other points to "
        "find these, or state [test] pairs. The results below assume this pairing"
    )
