"""Evidence of a candidate: the marginal likelihood integrated over the prior of its parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.special import logsumexp

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.fit import Peak, highest, maximise
from updating.diagnosis.search.goodness import p_value
from updating.diagnosis.search.points import Point, evaluate_many
from updating.diagnosis.search.ridges import along_ridge
from updating.diagnosis.search.sampling import Posterior, about, draw_posterior, enough, least
from updating.problem.candidate import Candidate
from updating.problem.screening import basins
from updating.steps import SingleCause
from updating.thresholds import (
    AT_REST,
    CLIMBS,
    DRAFT_SAMPLES,
    ENOUGH_SAMPLES,
    HOPELESS_BEHIND,
    LEAST_ON_LINE,
    PEAK_BEHIND,
    SAME_PEAK,
    STARTS_TRIED,
    STEPS_TRIED,
)


@dataclass(frozen=True, eq=False)
class Explanation:
    """A candidate after comparison with the data.

    Parameters
    ----------
    candidate : Candidate
        The effects.
    log_evidence : float
        Logarithm of the evidence, the prior share of the effects' forms in it [-].
    best : Point
        Most probable parameters.
    samples : (m, k) array
        Posterior samples as prior quantiles [-].
    weights : (m,) array
        Their weights, summing to 1 [-].
    peaks : tuple of Peak
        The maxima found.
    laplace_only : bool
        Whether the samples were weighted by parabolas only.
    other : float
        Logarithm of what the evidence of the other theory adds, relative to this one's [-].
    effective : float
        As how many independent samples of the posterior the weighted ones are worth; nothing of a draft [-].
    wanted : float
        As how many they were to be worth; nothing of a draft [-].
    """

    candidate: Candidate
    log_evidence: float
    best: Point
    samples: FloatArray
    weights: FloatArray
    peaks: tuple[Peak, ...] = ()
    laplace_only: bool = False
    other: float = 0.0
    effective: float = 0.0
    wanted: float = 0.0

    def lacks_samples(self, share: float) -> bool:
        """Return whether it is a draft, or was given too few for its share of the best one's probability."""
        wanted = enough(self.samples.shape[1], share)
        return self.laplace_only or (self.wanted < wanted and 0 < self.effective < wanted)

    @property
    def settled(self) -> bool:
        """Whether its evidence rests on enough samples to be one; that of a draft, or without a parameter, does."""
        return not 0 < self.effective < least(self.samples.shape[1])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return self.candidate.names

    @cached_property
    def p_value(self) -> float:
        """How well the best parameters fit: the p-value of chi-squared over all data and each channel [-]."""
        return p_value(self.best, self.samples.shape[1])

    @property
    def tops(self) -> list[FloatArray]:
        """Prior quantiles of its maxima, from which to search where little is different."""
        return [peak.point.coordinates for peak in self.peaks] or [self.best.coordinates]

    def restricted(self, candidate: Candidate, columns: IntArray) -> Explanation:
        """Return its result for some of its effects alone, of those whose coordinates are ``columns``."""
        best = replace(self.best, coordinates=self.best.coordinates[columns])
        return replace(self, candidate=candidate, best=best, samples=self.samples[:, columns], peaks=())


def explain(
    problem: DiagnosisProblem,
    candidate: Candidate,
    *,
    starts: list[FloatArray] | None = None,
    begun: Sequence[Point] | None = None,
    laplace_only: bool = False,
    maximisations: int = CLIMBS,
    bar: float = -np.inf,
) -> Explanation:
    """Evaluate a candidate.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    candidate : Candidate
        Effects.
    starts : list of (k,) arrays, optional
        Prior quantiles to start from; left out, the effects' own.
    begun : sequence of Point, optional
        To where :func:`attempts` led from them, where these are made already.
    laplace_only : bool
        Whether the samples are weighted by the parabolas through the peaks instead of by predictions: enough to
        separate the hopeless from the rest.
    maximisations : int
        From how many starting places, those that a short maximisation finds best, the search goes on to the top.
    bar : float
        Log-likelihood that another candidate has reached; what stays far below it is searched less closely.

    Returns
    -------
    Explanation
    """
    if begun is None:
        places = _beginnings(problem, candidate) if starts is None else starts
        begun = evaluate_many(problem, candidate, places)
        if len(places) > maximisations:
            begun = _after_few_steps(problem, candidate, begun, bar)[:maximisations]
    if len(begun[0].coordinates) == 0:
        evidence = _height(begun[0]) + candidate.log_weight
        return Explanation(candidate, evidence, begun[0], np.zeros((1, 0)), np.ones(1))
    peaks = _peaks(problem, candidate, begun, bar)
    if not peaks[0].point.possible:
        return Explanation(candidate, -np.inf, peaks[0].point, begun[0].coordinates[None, :], np.ones(1))
    if laplace_only:
        draft = draw_posterior(partial(_parabolas, peaks), about(peaks), DRAFT_SAMPLES, most=DRAFT_SAMPLES)
        return _explanation(candidate, peaks[0].point, draft, peaks, laplace_only=True)
    return _sampled(problem, candidate, peaks)


def attempts(problem: DiagnosisProblem, candidate: Candidate, *, bar: float = -np.inf) -> list[Point]:
    """Return to where a few steps from a candidate's own starts lead, the best first: from there its search goes on.

    Parameters
    ----------
    problem, candidate, bar
        As in :func:`explain`.
    """
    points = evaluate_many(problem, candidate, _beginnings(problem, candidate))
    return _after_few_steps(problem, candidate, points, bar)[:CLIMBS]


def either(plain: Explanation, fuller: Explanation) -> Explanation:
    """Return the better of one set on two theories, with half the evidence of each."""
    total = float(np.logaddexp(plain.log_evidence, fuller.log_evidence) - np.log(2))
    chosen = max(plain, fuller, key=lambda e: e.log_evidence)
    return replace(chosen, log_evidence=total, other=total - chosen.log_evidence)


def _beginnings(problem: DiagnosisProblem, candidate: Candidate) -> list[FloatArray]:
    """Return where a search begins: of a local effect at the best places of a grid, else at the effects' own starts."""
    placed = basins(candidate, problem.predictor) if len(problem.specimens) == 1 else []
    return placed or problem.starts(candidate)


def finish(problem: DiagnosisProblem, explanation: Explanation, *, share: float = 1.0) -> Explanation:
    """Evaluate a Laplace approximation by predictions, from the maxima it found.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    explanation : Explanation
        A draft.
    share : float
        Its probability beside that of the best: what is improbable needs its evidence less closely [-].
    """
    wanted = enough(explanation.samples.shape[1], share)
    found = _sampled(problem, explanation.candidate, list(explanation.peaks), wanted=wanted)
    return replace(found, log_evidence=found.log_evidence + explanation.other, other=explanation.other)


def _sampled(
    problem: DiagnosisProblem,
    candidate: Candidate,
    peaks: list[Peak],
    *,
    wanted: float = ENOUGH_SAMPLES,
    at_once: int = 16,
) -> Explanation:
    """Return the evidence by predictions at samples about maxima, ``at_once`` at a time to bound the memory.

    Where the prediction has to be linearised anew each sample begins at the nearest one before, so one at a time. Where
    too few samples carry the weight and the best of them is above every maximum, a maximum was missed: it is searched
    from there, and samples are drawn about it, too.
    """
    at_once = 1 if problem.wide else at_once
    peaks = [*peaks, *along_ridge(problem, candidate, peaks[0])]
    top = best = max((peak.point for peak in peaks), key=_height)
    known = [(peak.point.coordinates, peak.point.about) for peak in peaks]

    def log_likelihood(samples: FloatArray) -> FloatArray:
        nonlocal best
        heights: list[float] = []
        for some in np.array_split(samples, -(-len(samples) // at_once)) if len(samples) else ():
            places = np.array([there for there, _ in known])
            nearest = ((some[:, None] - places) ** 2).sum(axis=2).argmin(axis=1)
            points = evaluate_many(problem, candidate, some, abouts=[known[i][1] for i in nearest])
            heights, best = heights + [_height(point) for point in points], max(best, *points, key=_height)
            known.extend((point.coordinates, point.about) for point in points)
        return np.array(heights)

    count = 2 ** math.floor(math.log2(2 * wanted))  # about half of a good proposal's samples are independent
    found = draw_posterior(log_likelihood, about(peaks), count, wanted=wanted)
    if found.effective < least(len(peaks[0].gradient)) and _height(best) > _height(top) + AT_REST:
        peaks = [maximise(problem, candidate, best), *peaks]
        best = max(best, peaks[0].point, key=_height)
        found = draw_posterior(log_likelihood, about(peaks), count, wanted=wanted)
    return replace(_explanation(candidate, best, found, peaks), wanted=wanted)


def _height(point: Point) -> float:
    return point.marginal.log_likelihood


def _explanation(
    candidate: Candidate, best: Point, found: Posterior, peaks: list[Peak], *, laplace_only: bool = False
) -> Explanation:
    evidence = found.log_evidence + candidate.log_weight
    return Explanation(
        candidate,
        evidence,
        best,
        found.samples,
        found.weights,
        tuple(peaks),
        laplace_only,
        effective=0.0 if laplace_only else found.effective,
    )


def _parabolas(peaks: list[Peak], samples: FloatArray) -> FloatArray:
    """Return the highest of the log-likelihood's parabolas through the peaks, at some samples [-]."""
    found = []
    for peak in peaks:
        away = samples - peak.point.coordinates
        slope = peak.outward
        curve = 0.5 * np.einsum("si,ij,sj->s", away, peak.normal, away)
        found.append(peak.point.marginal.log_likelihood + away @ slope - curve)
    return np.asarray(np.max(found, axis=0))


def _after_few_steps(
    problem: DiagnosisProblem, candidate: Candidate, starts: Sequence[Point], bar: float
) -> list[Point]:
    """Return to where a few steps from the best starts lead, those in different places, the best first."""
    if len(starts[0].coordinates) == 0:
        return list(starts)
    heights = np.array([_height(point) for point in starts])
    nearest = np.argsort(heights)[::-1][:STARTS_TRIED]
    if len(starts) > CLIMBS and _on_a_line([point.coordinates for point in starts]):
        nearest = nearest[_maxima(heights)[nearest]]
    tried = [highest(problem, candidate, starts[i], rounds=STEPS_TRIED, bar=bar) for i in nearest]
    return [tried[i] for i in _distinct(tried, _exchanged(problem, candidate))]


def _peaks(problem: DiagnosisProblem, candidate: Candidate, begun: Sequence[Point], bar: float) -> list[Peak]:
    """Return the maxima above some points, the highest first; of what stays hopelessly below the bar, one alone."""
    peaks: list[Peak] = []
    for point in sorted(begun, key=_height, reverse=True):
        reached = max(_height(one) for one in (point, *(peak.point for peak in peaks)))
        if peaks and bar - reached >= HOPELESS_BEHIND:
            break
        peaks.append(maximise(problem, candidate, point, bar=bar))
    found = [peaks[i] for i in _distinct([peak.point for peak in peaks], _exchanged(problem, candidate))]
    top = _height(found[0].point)
    return [peak for peak in found if peak is found[0] or top - _height(peak.point) < PEAK_BEHIND]


def _on_a_line(places: list[FloatArray]) -> bool:
    """Return whether places follow each other along a straight line on which every parameter changes."""
    steps = np.diff(np.stack(places), axis=0)
    first = steps[0] / max(float(np.linalg.norm(steps[0])), 1e-300)
    straight = np.allclose(steps, np.outer(steps @ first, first), atol=1e-9)
    return bool(straight and (steps @ first > 0).all() and (np.abs(first) > LEAST_ON_LINE).all())


def _maxima(heights: FloatArray) -> BoolArray:
    """Return which heights along a line are no lower than their neighbours: searches from the others end there, too."""
    around = np.concatenate([[-np.inf], np.nan_to_num(heights, nan=-np.inf), [-np.inf]])
    level = around[1:-1] + AT_REST  # on level ground all are
    return np.asarray((level >= around[:-2]) & (level >= around[2:]))


def _exchanged(problem: DiagnosisProblem, candidate: Candidate) -> IntArray | None:
    """Return the order of the parameters after two of one effect in one form are exchanged, (k,); None where none are.

    Both orders are one explanation: samples from both would mix the sizes and places of the two.
    """
    names, forms = candidate.names, candidate.forms
    if len(problem.specimens) > 1 or len(names) != 2 or names[0] != names[1] or forms[0] != forms[1]:
        return None
    count = len(problem.parameters(candidate))
    return np.roll(np.arange(count), count // 2)


def _distinct(points: Sequence[Point], swap: IntArray | None) -> list[int]:
    """Return which points are not in the same place as a higher one, the highest first.

    Nor are those that are in its place with the parameters in the order ``swap`` (k,).
    """
    kept: list[int] = []
    for i in sorted(range(len(points)), key=lambda i: -points[i].marginal.log_likelihood):
        here = points[i].coordinates
        orders = [here] if swap is None else [here, here[swap]]
        known = (points[j].coordinates for j in kept)
        if all(np.abs(one - other).max() >= SAME_PEAK for other in known for one in orders):
            kept.append(i)
    return kept


def single_cause(name: str, found: Sequence[Explanation], nothing: Explanation) -> SingleCause:
    """Return an effect by those of its forms that are compared.

    Parameters
    ----------
    name : str
        Its name.
    found : sequence of Explanation
        All that is compared so far; a form of the effect is among it.
    nothing : Explanation
        No effect at all.
    """
    own = [one for one in found if one.names == (name,)]
    best = max(own, key=lambda one: one.log_evidence)
    total = float(logsumexp([one.log_evidence for one in own]))
    return SingleCause(name, total - nothing.log_evidence, best.p_value)
