"""Several solutions: frequencies alone may be met by models that are not the structure, a mirror image for one.

Where the first solution misses the frequencies, or its shapes are not those measured, the iteration is repeated
from other starts within the tolerances, and the solution that explains frequencies and shapes best is taken.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2, norm, qmc

from acquisition.arrays import FloatArray
from updating.update.affine import eligible
from updating.update.solve import Solution, solve
from updating.update.specimen import Look, Specimen
from updating.update.system import System

IMPROBABLE = 1e-3
"""A misfit less probable than this asks for another look."""

SHAPE_ERROR = 0.02
"""Error of a model's shapes that is taken as given, over their r.m.s. [-]."""

STARTS = 5
"""Binary logarithm of the number of starts that are tried."""

SAME = 3.0
"""Solutions are told apart if frequencies and shapes prefer one by more than this in chi-square [-]."""


def best_solution(system: System) -> tuple[Solution, tuple[str, ...]]:
    """Return the solution that explains frequencies and shapes best, and what there is to say of others.

    Parameters
    ----------
    system : System
        The problem.
    """
    first = solve(system)
    plain = all(eligible(s.panel.knobs) for s in system.specimens)
    if not plain or not np.all(system.prior > 0) or not _doubtful(system, first):
        return first, ()
    found = [first]
    for start in _starts(system):
        found.append(solve(system, start))
    price = np.array([_price(system, s) for s in found])
    best = found[int(np.argmin(price))]
    near = [s for s, p in zip(found, price, strict=True) if p < price.min() + SAME]
    apart = max(float(np.max(np.abs(s.theta - best.theta) / system.doubt)) for s in near)
    if apart > 1.0:
        return best, (
            "other values of the parameters explain the data as well (a mirror image, for instance); measured shapes "
            'or data = ["frequencies", "shapes"] tell them apart',
        )
    return best, ()


def _starts(system: System) -> list[FloatArray]:
    """Return coordinates spread over the doubts, the same at every call."""
    points = qmc.Sobol(len(system.start), scramble=False).random_base2(STARTS)[1:]
    return [np.clip(system.start + system.doubt * norm.ppf(p), system.low, system.high) for p in points]


def _doubtful(system: System, solution: Solution) -> bool:
    """Tell whether frequencies or shapes are missed by more than chance allows."""
    both = zip(system.specimens, solution.looks, strict=True)
    parts = [(_frequency_misfit(s, k), len(k.frequency), *shape_misfit(s, k)) for s, k in both]
    wrong = sum(p[0] for p in parts), sum(p[1] for p in parts)
    shapes = sum(p[2] for p in parts), sum(p[3] for p in parts)
    return any(n > 0 and chi2.sf(value, n) < IMPROBABLE for value, n in (wrong, shapes))


def _price(system: System, solution: Solution) -> float:
    shapes = [shape_misfit(s, k)[0] for s, k in zip(system.specimens, solution.looks, strict=True)]
    return system.cost(solution.theta, solution.looks) + float(sum(shapes))


def _frequency_misfit(specimen: Specimen, look: Look) -> float:
    return float(np.sum((1 - look.frequency / specimen.measured.frequency) ** 2 / specimen.relative_variance))


def shape_misfit(specimen: Specimen, look: Look) -> tuple[float, int]:
    """Return the misfit of the shapes up to a factor per mode, in variances, and its degrees of freedom.

    The variance is that of the constants with the error of the points hit left to ``SHAPE_ERROR``.
    """
    test = specimen.measured
    if not test.has_shapes:
        return 0.0, 0
    a, b = test.constants, look.prediction.constants
    own = SHAPE_ERROR**2 * np.mean(a**2, axis=0, keepdims=True)
    weight = 1 / (test.constants_sigma**2 + own)
    scale = np.sum(weight * a * b, axis=0) / np.maximum(np.sum(weight * b * b, axis=0), 1e-300)
    return float(np.sum(weight * (a - scale * b) ** 2)), int(a.size - a.shape[1])
