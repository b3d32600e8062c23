"""Several solutions: frequencies alone may be met by models that are not the structure, a mirror image for one.

The iteration is repeated from other starts within the tolerances, and the solution that explains frequencies and
shapes best is taken. Others that explain them about as well count in what is stated about its errors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2, norm, qmc

from acquisition.arrays import FloatArray
from updating.update.data.nominal import Evaluation
from updating.update.data.specimen import Specimen
from updating.update.data.system import System
from updating.update.estimate import Estimate
from updating.update.parameters.affine import eligible
from updating.update.parameters.parameters import ModelParameter
from updating.update.solve import Solution, solve
from updating.update.statistics.mixture import NOTICED, Mixture, laplace

IMPROBABLE = 1e-3
"""A misfit less probable than this asks for another look."""

SHAPE_ERROR = 0.02
"""Error of a model's shapes that is taken as given, over their r.m.s. [-]."""

STARTS = (4, 5)
"""Binary logarithm of the number of starts that are tried, where the first solution is sound and where not."""

FARTHEST = 0.3
"""So far starts spread in the logarithm of a factor, however wide its tolerance [-]: models of other structures lead
nowhere. Doubled: half of the starts of eighteen storeys find no solution."""

EASED = 3.0
"""Factor between the sigmas that frequencies are taken to have on the way to theirs [-]. Doubled: half the steps, and
now and then the wrong valley."""

STEPS = 20
"""Most steps from each of them."""

ROUGH = 1e-4
"""Increments under this share of the doubts end these iterations [-]."""

HOPELESS = 20.0
"""Solutions that explain everything worse than the best by more than this in chi-square are dropped [-]."""

ALIKE = 0.01
"""Solutions nearer than this, in doubts, are one [-]."""


@dataclass(frozen=True, eq=False)
class Others:
    """Solutions beside the one that is reported.

    Parameters
    ----------
    solutions : tuple of Solution
        They.
    cost : (n,) array
        By how much each explains data, tolerances and measured shapes worse than the reported one, in variances;
        may be negative no further than rounding [-].
    """

    solutions: tuple[Solution, ...]
    cost: FloatArray


NONE = Others((), np.zeros(0))
"""No other solution, or none that was sought."""


Price = Callable[[System, Solution], float]
"""How badly a solution explains everything, in variances up to a constant."""


def best_solution(system: System, price: Price | None = None) -> tuple[Solution, Others]:
    """Return the solution that explains frequencies and shapes best, and the others.

    They are sought from other starts where tolerances hold all parameters, and frequencies alone are data or
    the first solution is doubtful.

    Parameters
    ----------
    system : System
        The problem.
    price : callable, optional
        What the best has the least of; left out, the misfit of all data at the errors that are stated of them.
    """
    first = solve(system)
    plain = all(eligible(s.parameter_set.model_parameters) for s in system.specimens)
    if plain and chi2.sf(system.cost(first.theta, first.evaluations), system.count) < IMPROBABLE:
        first = min(first, _eased(system), key=lambda s: system.cost(s.theta, s.evaluations))
    if not plain or not np.all(system.prior > 0):
        return first, NONE
    doubtful = _doubtful(system, first)
    if system.shapes and not doubtful:
        return first, NONE
    found = [first]
    for start in _starts(system, STARTS[doubtful]):
        other = solve(system, start, steps=STEPS, rest=ROUGH)
        if not _known(other, found, system.doubt):
            found.append(other)
    costs = np.array([(price or _price)(system, s) for s in found])
    order = np.argsort(costs, kind="stable")
    best = found[order[0]] if order[0] == 0 else solve(system, found[order[0]].theta)
    rest = [i for i in order[1:] if costs[i] < costs[order[0]] + HOPELESS]
    return best, Others(tuple(found[i] for i in rest), costs[rest] - costs[order[0]])


def mixture(system: System, best: Solution, covariance: FloatArray, others: Others) -> Mixture:
    """Weigh the solutions against one another; ``covariance`` (p, p) is that about the best."""
    about = [covariance]
    for solution in others.solutions:
        linear = system.linear(solution.theta, system.evaluations(solution.theta))
        scaled = np.sqrt(linear.weight)[:, None] * linear.sensitivity
        about.append(np.asarray(np.linalg.inv(scaled.T @ scaled + np.diag(system.prior))))
    centre = np.stack([best.theta, *(s.theta for s in others.solutions)])
    return laplace(np.append(0.0, others.cost), centre, np.stack(about))


def within(estimate: Estimate, model_parameter: ModelParameter, several: Mixture, index: int) -> Estimate:
    """Return an estimate with the interval that holds all solutions."""
    low, high = (
        model_parameter.nominal * model_parameter.value(float(end)) for end in several.interval()[index]
    )
    return replace(estimate, interval=(low, high))


def notes_on_others(system: System, several: Mixture | None) -> tuple[str, ...]:
    """State which parameters other solutions turn otherwise."""
    if several is None:
        return ()
    own = np.sqrt(np.diag(several.covariance[0]))
    away = np.abs(several.centre - several.centre[0]) > 2 * own
    turned = np.any(away & (several.weight > NOTICED)[:, None], axis=0)
    names = ", ".join(n for n, t in zip(system.names, turned, strict=True) if t)
    return (
        f"{several.solutions} solutions explain the data about as well (a mirror image, for instance)"
        + (f" and differ in {names}" if names else "")
        + '; standard deviations and intervals are those of all; data = ["frequencies", "shapes"] '
        "separates them",
    )


def _eased(system: System) -> Solution:
    """Return a solution that tolerances lead to: frequencies count for little at first, and step by step for more.

    Where frequencies are sharp the first step to meet them takes parameters along that tolerances hold; what it moves
    afterwards it moves only along the frequencies. Eased, it is what tolerances leave loose that moves.
    """
    theta = system.start
    missed = system.frequency_misfit(system.evaluations(theta)) / max(len(system.used), 1)
    ease = max(float(np.sqrt(missed)), 1.0)
    while ease > 1:
        dull = replace(system, weights=tuple(w / ease**2 for w in system.weights))
        theta = solve(dull, theta, steps=STEPS, rest=ROUGH).theta
        ease /= EASED
    return solve(system, theta)


def _known(solution: Solution, found: list[Solution], doubt: FloatArray) -> bool:
    """Return whether a solution is one of those found."""
    return any(np.max(np.abs(solution.theta - s.theta) / doubt) < ALIKE for s in found)


def _starts(system: System, power: int) -> list[FloatArray]:
    """Return coordinates spread over the doubts, the same at every call."""
    points = qmc.Sobol(len(system.start), scramble=False).random_base2(power)[1:]
    log = np.array([k.log for k in system.model_parameters])
    reach = np.where(log, np.minimum(system.doubt, FARTHEST), system.doubt)
    return [np.clip(system.start + reach * norm.ppf(p), system.low, system.high) for p in points]


def _doubtful(system: System, solution: Solution) -> bool:
    """Return whether frequencies, shapes, or all data together are missed by more than chance allows."""
    left = float(system.weight @ system.residual(solution.evaluations) ** 2)
    if system.shapes and chi2.sf(left, system.count) < IMPROBABLE:
        return True
    both = zip(system.specimens, solution.evaluations, strict=True)
    parts = [(_frequency_misfit(s, k), len(k.frequency), *shape_misfit(s, k)) for s, k in both]
    wrong = sum(p[0] for p in parts), sum(p[1] for p in parts)
    shapes = sum(p[2] for p in parts), sum(p[3] for p in parts)
    return any(n > 0 and chi2.sf(value, n) < IMPROBABLE for value, n in (wrong, shapes))


def _price(system: System, solution: Solution) -> float:
    shapes = [shape_misfit(s, k)[0] for s, k in zip(system.specimens, solution.evaluations, strict=True)]
    return system.cost(solution.theta, solution.evaluations) + float(sum(shapes))


def _frequency_misfit(specimen: Specimen, evaluation: Evaluation) -> float:
    return float(
        np.sum((1 - evaluation.frequency / specimen.measured.frequency) ** 2 / specimen.relative_variance)
    )


def shape_misfit(specimen: Specimen, evaluation: Evaluation) -> tuple[float, int]:
    """Return the misfit of the shapes up to a factor per mode, in variances, and its degrees of freedom.

    The variance is that of the constants with the error of the points hit left to ``SHAPE_ERROR``.
    """
    test = specimen.measured
    if not test.has_shapes:
        return 0.0, 0
    a, b = test.constants, evaluation.prediction.constants
    own = SHAPE_ERROR**2 * np.mean(a**2, axis=0, keepdims=True)
    weight = 1 / (test.constants_sigma**2 + own)
    scale = np.sum(weight * a * b, axis=0) / np.maximum(np.sum(weight * b * b, axis=0), 1e-300)
    return float(np.sum(weight * (a - scale * b) ** 2)), int(a.size - a.shape[1])
