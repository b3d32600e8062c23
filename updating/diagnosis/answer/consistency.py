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
from updating.diagnosis.search.fit import maximise, sensitivities
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import normal_equations
from updating.thresholds import REFIT_STEPS, SHORT_STEP, UNSEEN_CURVATURE

POINTS = "one half of the points and the other"
"""How the data are split by points."""


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
        return f"{self.parts} want {self.parameter} at sizes {self.sigma:.2g} sigma apart"


def splits(
    problem: DiagnosisProblem, explanation: Explanation, *, rules: DecisionRules = DEFAULT_RULES
) -> tuple[Split, ...]:
    """Return the parameters that both parts of the data determine and put at different sizes.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    explanation : Explanation
        A set of causes at its best.
    rules : DecisionRules
        What the answer is decided by.

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
    whole = explanation.best.comparison
    for parts, first, second in _halves(whole):
        seen = _with_free_levels(whole) if parts == POINTS else whole
        one, two = (_part(problem, explanation, seen, columns, keep, rules) for keep in (first, second))
        known = np.maximum(one.spread, two.spread) < rules.determined_spread
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
        halves.append((POINTS, shapes & ~odd, shapes & odd))
    pairs = comparison.of_pairs
    return [(name, a, b) for name, a, b in halves if (a & pairs).any() and (b & pairs).any()]


def _with_free_levels(comparison: Comparison) -> Comparison:
    """Return a comparison in which shapes are compared up to a factor for each mode.

    Shapes are in units of their mean square over all points: half of the points would see in it what the others have.
    """
    rows = np.flatnonzero(comparison.scaled & comparison.of_pairs)
    offset = np.zeros(2, dtype=int)
    whole = []
    for prediction in comparison.predictions:
        size = np.sqrt(np.mean(prediction.constants**2, axis=0, keepdims=True))
        whole.append((offset.copy(), prediction.constants / np.maximum(size, 1e-300)))
        offset += prediction.constants.shape
    modes = int(offset[1])
    levels = np.zeros((len(comparison.residual), modes))
    for (first_row, first_mode), shapes in whole:
        source, mode = comparison.source[rows] - first_row, comparison.mode[rows] - first_mode
        own = (source >= 0) & (source < len(shapes)) & (mode >= 0) & (mode < shapes.shape[1])
        levels[rows[own], comparison.mode[rows[own]]] = shapes[source[own], mode[own]]
    return comparison.beside(np.zeros((len(levels), 0)), levels)


def _part(
    problem: DiagnosisProblem,
    explanation: Explanation,
    comparison: Comparison,
    columns: FloatArray,
    keep: BoolArray,
    rules: DecisionRules,
) -> _Part:
    """Fit the parameters to some of the data: by a linear step where it is short, or where it determines nothing."""
    best = explanation.best
    rest = UNSEEN_CURVATURE * np.eye(columns.shape[1])
    normal, load = normal_equations(comparison, columns, best.marginal.scale, keep)
    there = np.clip(best.coordinates + np.linalg.solve(normal + rest, load), 0.0, 1.0)
    determined = np.sqrt(np.diag(np.linalg.inv(normal + rest))) < rules.determined_spread
    if determined.any() and np.abs(there - best.coordinates).max() > SHORT_STEP:
        peak = maximise(problem, explanation.candidate, best.coordinates, keep=keep, rounds=REFIT_STEPS)
        there, normal = peak.point.coordinates, peak.normal
    return _Part(there, np.asarray(np.linalg.inv(normal + rest)))
