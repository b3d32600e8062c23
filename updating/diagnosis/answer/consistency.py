"""Does one size of a cause explain the lower and the upper half of the modes, and of the points, alike?

A cause that is not the true one bends to what it is fitted to, so that its size in the low modes is not its size in the
high ones. Each half is taken on the linearisation about the best of all data, with its own nuisances.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.fit import maximise
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import normal_equations
from updating.thresholds import REFIT_STEPS, SHORT_STEP, UNSEEN_CURVATURE


@dataclass(frozen=True, eq=False)
class _Part:
    """The parameters as one part of the data has them.

    Parameters
    ----------
    coordinates : (k,) array
        Prior quantiles [-].
    covariance : (k, k) array
        Of these [-].
    """

    coordinates: FloatArray
    covariance: FloatArray

    @property
    def spread(self) -> FloatArray:
        """Standard deviations, (k,) [-]."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class Split:
    """A parameter that two parts of the data want at different sizes.

    Parameters
    ----------
    parameter : str
        As ``effect.parameter``.
    parts : str
        What the data were split by.
    sigma : float
        How far the two are apart, in standard deviations of the difference [-].
    """

    parameter: str
    parts: str
    sigma: float

    def __str__(self) -> str:
        """Return it as a clause."""
        return f"{self.parts} require values of {self.parameter} that are {self.sigma:.2g} sigma apart"


def splits(
    problem: DiagnosisProblem,
    explanation: Explanation,
    *,
    rules: DecisionRules = DEFAULT_RULES,
    least: float = 0.01,
) -> tuple[Split, ...]:
    """Return the parameters that both parts of the data determine and put at different sizes.

    A part that has next to nothing of what is known of a parameter is no test of it: the gain of one channel shows in
    all others by the common phase alone, a thousandth part of what it is where it acts, and so would any other error.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    explanation : Explanation
        A set of causes at its best.
    rules : DecisionRules
        What the answer is decided by.
    least : float
        Least information in one part over that in the other [-].

    Returns
    -------
    tuple of Split
        Those more than the rules allow apart, the farthest first.
    """
    if not len(explanation.best.coordinates):
        return ()
    columns = sensitivities(problem, explanation.candidate, explanation.best)
    names = [name for name, _ in problem.parameters(explanation.candidate)]
    found = []
    for parts, first, second in _halves(explanation.best.comparison):
        one, two = (_part(problem, explanation, columns, keep) for keep in (first, second))
        most, fewest = np.maximum(one.spread, two.spread), np.minimum(one.spread, two.spread)
        known = (most < rules.determined_spread) & (fewest**2 >= least * most**2)
        sigma = np.abs(one.coordinates - two.coordinates) / np.hypot(one.spread, two.spread)
        apart = known & (sigma > rules.split_sigma)
        found += [Split(names[i], parts, float(sigma[i])) for i in np.flatnonzero(apart)]
    return tuple(sorted(found, key=lambda split: -split.sigma))


def _halves(comparison: Comparison) -> list[tuple[str, BoolArray, BoolArray]]:
    """Return how the data may be split in two, and which data are in either part."""
    counts = [len(prediction.frequency) for prediction in comparison.predictions]
    rank = np.concatenate([np.arange(count) < (count + 1) // 2 for count in counts])
    lower, unpaired = rank[comparison.mode], ~comparison.of_pairs
    halves = [("the lower and the upper modes", lower | unpaired, ~lower | unpaired)]
    sources = np.unique(comparison.source[comparison.scaled])
    if len(sources) > 1:
        odd = np.isin(comparison.source, sources[1::2])
        shapes = comparison.scaled
        halves.append(("one half of the points and the other", shapes & ~odd, shapes & odd))
    pairs = comparison.of_pairs
    return [(name, a, b) for name, a, b in halves if (a & pairs).any() and (b & pairs).any()]


def _part(problem: DiagnosisProblem, explanation: Explanation, columns: FloatArray, keep: BoolArray) -> _Part:
    """Fit the parameters to some of the data: by a linear step where it is short."""
    best = explanation.best
    rest = UNSEEN_CURVATURE * np.eye(columns.shape[1])
    normal, load = normal_equations(best.comparison, columns, best.marginal.scale, keep)
    there = np.clip(best.coordinates + np.linalg.solve(normal + rest, load), 0.0, 1.0)
    if np.abs(there - best.coordinates).max() > SHORT_STEP:
        peak = maximise(problem, explanation.candidate, best.coordinates, keep=keep, rounds=REFIT_STEPS)
        there, normal = peak.point.coordinates, peak.normal
    return _Part(there, np.asarray(np.linalg.inv(normal + rest)))
