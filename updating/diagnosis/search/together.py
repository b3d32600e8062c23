"""Two sets of causes as one: what a linear step promises of them together, and their search from the best of either."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.gaussian import normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import CLIMBS

Part = tuple[Candidate, FloatArray]
"""A set of effects, and prior quantiles to start from."""


def join(
    problem: DiagnosisProblem,
    first: Part,
    second: Part,
    bar: float,
    *,
    anew: bool = False,
    places: Sequence[FloatArray] = (),
) -> Explanation:
    """Draft two sets as one, from the best that each has alone, and where asked from all its own starts anew.

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
    both = joined(one, two)
    unlike = list(
        {tuple(u.tolist()): u for u in starts}.values()
    )  # of an effect without parameters all are alike
    count = CLIMBS if anew else 1 + bool(places)
    return explain(problem, both, starts=unlike, laplace_only=True, maximisations=count, bar=bar)


def joined(one: Candidate, two: Candidate) -> Candidate:
    """Return the effects of two candidates, each in its form, as one."""
    return Candidate(one.effects + two.effects, fuller=one.fuller or two.fuller, chosen=one.forms + two.forms)


def same_place_twice(problem: DiagnosisProblem, one: Candidate, two: Candidate) -> bool:
    """Return whether an effect of one candidate is also in the other, at one and the same named place.

    A region whose mass is multiplied twice is multiplied once by the product: the two are one cause, and their sizes
    are not determined. What is searched for its place may be at two of them.
    """
    searched = {name for own in (one, two) for name, _ in problem.parameters(own)}
    placed = {effect.name for own in (one, two) for effect in own.effects if f"{effect.key}.x" in searched}
    pairs = [
        (form.values, other.values)
        for effect, form in zip(one.effects, one.forms, strict=True)
        for again, other in zip(two.effects, two.forms, strict=True)
        if effect.name == again.name and effect.name not in placed
    ]
    return any(dict(values) == dict(others) for values, others in pairs)


def once_more(single: Explanation) -> Explanation:
    """Return a single effect as the second of its kind."""
    again = replace(single.candidate, effects=tuple(effect.again() for effect in single.candidate.effects))
    return replace(single, candidate=again)


def score_tests(problem: DiagnosisProblem, singles: list[Explanation]) -> FloatArray:
    """Return the log-likelihood that a linear step from each single's best, with each other, would reach.

    Returns
    -------
    (n, n) array
        Row: whose best is the start; column: whose whole shift, and its sensitivities there, are added [-].
    """
    nominal = problem.at(Candidate(), np.zeros(0)).residual
    own = [sensitivities(problem, e.candidate, e.best) for e in singles]
    shifts = [(nominal - e.best.comparison.residual)[:, None] for e in singles]
    everything = np.hstack([np.hstack(pair) for pair in zip(shifts, own, strict=True)])
    everything[~np.isfinite(everything)] = 0.0  # a single that is impossible itself
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


def linear_step(normal: FloatArray, load: FloatArray) -> FloatArray:
    """Return the step that normal equations promise, the shortest one where effects do the same to the data.

    Two springs beside each other may shift the data so far that no prior's unit is left on the diagonal.

    Parameters
    ----------
    normal : (k, k) array
        Fisher information with that of the prior, so that its diagonal is positive [-].
    load : (k,) array
        Slope of the log-likelihood [-].
    """
    size = np.sqrt(np.diag(normal))
    return np.asarray(np.linalg.lstsq(normal / np.outer(size, size), load / size, rcond=1e-10)[0] / size)
