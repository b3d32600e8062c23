"""What fits once a few data are taken to be worse than stated: compared with the same explanation as it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.goodness import p_value
from updating.diagnosis.search.points import Point
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.likelihood.outliers import Outlier, log_price, suspects, with_outliers
from updating.thresholds import (
    MOST_ALONE,
    MOST_OUTLIERS,
    ODD_DATA_BELOW,
    QUANTILE_SPREAD,
    REJECTED_FIT,
    SUSPECTS_TRIED,
    WITHIN_REACH,
)


@dataclass(frozen=True, eq=False)
class _Choice:
    """Outliers, and what is gained by them before anything is fitted anew."""

    outliers: tuple[Outlier, ...]
    gain: float
    point: Point


def with_odd_data(problem: DiagnosisProblem, found: Sequence[Explanation]) -> list[Explanation]:
    """Evaluate again, with outliers, what does not fit but would with them, and beside it what has as much evidence.

    No effect at all is among the latter, or a cause would be believed for the data that it alone may set aside.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    found : sequence of Explanation
        As they stand.

    Returns
    -------
    list of Explanation
        Those that fit with outliers and come within reach of the best, drafted.
    """
    doubtful = [one for one in found if one.best.possible and one.p_value < ODD_DATA_BELOW]
    choices = [(one, _choose(problem, one)) for one in doubtful]
    taken = [one.log_evidence for one, choice in choices if choice.outliers]
    if taken:  # the same data may be odd beside what fits without: a fit of many data hides one
        level = min(taken)
        further = [one for one in found if one not in doubtful and one.best.possible]
        choices += [(one, _choose(problem, one)) for one in further if one.log_evidence >= level]
    reached = [one.log_evidence + choice.gain for one, choice in choices]
    bar = max([one.log_evidence for one in found] + reached, default=-np.inf) - WITHIN_REACH
    return [
        _again(problem, one, choice)
        for (one, choice), score in zip(choices, reached, strict=True)
        if choice.outliers and score > bar and p_value(choice.point, one.samples.shape[1]) >= REJECTED_FIT
    ]


def _choose(problem: DiagnosisProblem, explanation: Explanation) -> _Choice:
    """Take the groups of data as outliers, one after the other, whose price the rest of the data outweigh."""
    best = explanation.best
    columns = sensitivities(problem, explanation.candidate, best)
    # the parameters follow as far as they may: nuisances, as wide as their priors
    free = replace(best.comparison, nuisance=np.hstack([best.comparison.nuisance, QUANTILE_SPREAD * columns]))
    chosen: tuple[Outlier, ...] = ()
    start = here = _point(free, best.coordinates)
    for _ in range(MOST_OUTLIERS if explanation.names else MOST_ALONE):
        tried = [
            (*chosen, outlier)
            for suspect in suspects(here.comparison, here.marginal.scale, SUSPECTS_TRIED)
            for outlier in suspect.scaled()
            if (explanation.names or outlier.of_shape) and not any(map(outlier.about_the_same, chosen))
        ]
        if not tried:
            break
        points = [_point(with_outliers(free, outliers), best.coordinates) for outliers in tried]
        top = int(np.argmax([point.marginal.log_likelihood for point in points]))
        gain = points[top].marginal.log_likelihood - here.marginal.log_likelihood
        if gain + log_price(tried[top][-1:]) <= 0:
            break
        chosen, here = tried[top], points[top]
    gained = here.marginal.log_likelihood - start.marginal.log_likelihood + log_price(chosen)
    return _Choice(chosen, gained, here)


def _point(comparison: Comparison, coordinates: FloatArray) -> Point:
    return Point(coordinates, comparison, marginal(comparison))


def _again(problem: DiagnosisProblem, explanation: Explanation, choice: _Choice) -> Explanation:
    """Draft an explanation with its outliers, from where the remaining data put its parameters."""
    best = explanation.best.coordinates
    step = QUANTILE_SPREAD * choice.point.marginal.shift[len(choice.point.marginal.shift) - len(best) :]
    starts = [np.clip(best + step, 0.0, 1.0), best] if len(best) else [best]
    candidate = replace(explanation.candidate, outliers=choice.outliers)
    again = explain(problem, candidate, starts=starts, laplace_only=True, maximisations=1)
    return replace(again, log_evidence=again.log_evidence + explanation.other, other=explanation.other)
