"""How far measured shapes err beyond what was stated of them, and how much weight they then have.

A shape's sigma is the least known number of a test: transducers, directions and the form of the model err alike over
many points. It is estimated from what the model leaves of the shapes, for all modes in common and, held near that,
for each. It starts large, so that frequencies have the first word, and falls to what the misfit asks for. Should the
shapes still pull the frequencies further than these admit, their errors are not independent from point to point, and
they count for less until frequencies and shapes agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2

from acquisition.arrays import FloatArray
from updating.test_data.taken import GUESSED_SHAPE_SIGMA
from updating.update.data.system import Linear, System
from updating.update.solve import Solution, solve
from updating.update.statistics.leverage import leverage
from updating.update.statistics.solutions import Others, best_solution

CHANCE = 1e-3
"""A misfit less probable than this is not chance [-]."""

RANGE = (1e-4, 2.0)
"""Between these an error of shapes lies, over their r.m.s. [-]: what no test reaches, and twice the shape itself."""

HELD = 4.0
"""So many data does what is known beforehand count as: a guess of the common error, and that of each mode [-].
Doubled: one bad shape among a dozen points is found half as bad."""

ROUNDS = 12
"""Most estimates one after the other; an error over-rated by a hundred is then found to a per cent."""

SETTLED = 0.02
"""Relative change of the errors from which on they are found [-]: a fifth of what data of a hundred points give."""

RAISED = 2.0
"""Factor by which errors grow while shapes contradict the frequencies [-]. Doubled: some shapes that could determine
more of the parameters are given less weight."""


@dataclass(frozen=True, eq=False)
class Agreed:
    """A problem whose shapes count for what they are good for, and its solution.

    Parameters
    ----------
    system : System
        The problem.
    solution : Solution
        Where the iteration came to rest.
    others : Others
        Other solutions that explain the data about as well.
    contradicted : bool
        Whether the shapes were made to count for less because they pulled the frequencies off.
    """

    system: System
    solution: Solution
    others: Others
    contradicted: bool = False


def agreed(system: System) -> Agreed:
    """Solve a problem, with the errors of its shapes estimated where stated ones do not explain what is left."""
    guessed = system.shapes and any(s.measured.guessed for s in system.specimens if s.measured.has_shapes)
    if not guessed:
        solution, others = best_solution(system)
        if not system.shapes:
            return Agreed(system, solution, others)
        if _by_chance(system, solution):
            return _reconciled(Agreed(system, solution, others))
    system = system.discrepant([np.full(len(s.number), RANGE[1]) for s in system.specimens])
    # shapes that may be off by twice their size do not determine parameters, but largely which solution is right
    alone = replace(system, shapes=False)
    solution, others = best_solution(alone, lambda _, found: _of_any_size(system, found))
    system, solution = _estimated(system, solution)
    return _reconciled(Agreed(system, solution, others))


def _of_any_size(system: System, solution: Solution) -> float:
    """Return how badly a solution explains all data, errors of the shapes being of any size.

    A size that may be anything leaves n ln(sum of squares) of n squared residuals: each mode's own.
    """
    total = replace(system, shapes=False).cost(solution.theta, solution.evaluations)
    left, end = system.residual(solution.evaluations), system.count_of_frequencies
    for test in (s.measured for s in system.specimens if s.measured.has_shapes):
        begin, end = end, end + test.constants.size
        square = np.sum(left[begin:end].reshape(test.constants.shape) ** 2, axis=0)
        total += len(test.seen) * float(np.sum(np.log(np.maximum(square, 1e-300))))
    return total


def _by_chance(system: System, solution: Solution) -> bool:
    """Return whether stated errors explain what is left of the shapes."""
    linear = system.linear(solution.theta, solution.evaluations)
    parts = [p for p in _parts(system, linear) if p is not None]
    return all(chi2.sf(p.square.sum(), max(p.free.sum(), 1.0)) > CHANCE for p in parts)


def _estimated(system: System, solution: Solution) -> tuple[System, Solution]:
    """Estimate errors and parameters in turns until the errors stay."""
    for _ in range(ROUNDS):
        parts = _parts(system, system.linear(solution.theta, solution.evaluations))
        sizes = [np.zeros(0) if part is None else part.sizes() for part in parts]
        both = zip(system.specimens, sizes, strict=True)
        before = [s.nominal.discrepancy for s, new in both if len(new)]
        system = system.discrepant(sizes)
        solution = _further(system, solution)
        after = [new for new in sizes if len(new)]
        if all(_close(a, b) for a, b in zip(before, after, strict=True)):
            break
    return system, solution


def _further(system: System, solution: Solution) -> Solution:
    """Solve from a solution on, and keep the course to it."""
    found = solve(system, solution.theta)
    return replace(found, history=np.vstack([solution.history, found.history[1:]]))


def _close(before: FloatArray | None, after: FloatArray) -> bool:
    return before is not None and bool(
        np.all(np.abs(after - before) <= SETTLED * np.maximum(after, RANGE[0]))
    )


def _reconciled(found: Agreed) -> Agreed:
    """Let shapes count for less until the frequencies are met about as well as without them."""
    system, solution = found.system, found.solution
    alone = replace(system, shapes=False)
    free = solve(alone, solution.theta)
    modes = int(system.used.sum())
    admitted = alone.frequency_misfit(free.evaluations) + float(chi2.isf(CHANCE, modes))
    raised = 1.0
    own = [s.shape_sigma if s.measured.has_shapes else np.zeros(0) for s in system.specimens]
    while system.frequency_misfit(solution.evaluations) > admitted and raised < RANGE[1] / RANGE[0]:
        raised *= RAISED
        system = system.discrepant([raised * size for size in own])
        solution = _further(system, solution)
    return replace(found, system=system, solution=solution, contradicted=raised > 1)


@dataclass(frozen=True, eq=False)
class _Part:
    """What is left of one specimen's shapes.

    Parameters
    ----------
    square : (n_frf, n_modes) array
        Squares of the whitened residuals [-].
    free : (n_modes,) array
        Degrees of freedom left in each mode [-].
    now, stated : (n_frf, n_modes) arrays
        Variance of each component as it is taken now, and without a discrepancy, over the mode's mean square [-].
    guess : float
        Error that is guessed beforehand; 0 where one was stated [-].
    """

    square: FloatArray
    free: FloatArray
    now: FloatArray
    stated: FloatArray
    guess: float

    def sizes(self) -> FloatArray:
        """Return the discrepancy of every mode (n_modes,), 0 where stated errors explain what is left [-]."""
        bare = float((self.square * self.now / self.stated).sum())
        if not self.guess and chi2.sf(bare, max(self.free.sum(), 1.0)) > CHANCE:
            return np.zeros(len(self.free))
        modes, held = range(len(self.free)), HELD if self.guess else 0.0
        alone = np.median(
            [self._size(m, 0.0, 0.0) for m in modes]
        )  # one bad mode is no evidence on the others
        common = np.sqrt(
            (self.free.sum() * alone**2 + held * self.guess**2) / max(self.free.sum() + held, 1e-9)
        )
        return np.array([self._size(m, HELD, float(common)) for m in modes])

    def _size(self, mode: int, held: float, near: float) -> float:
        """Return the discrepancy of a mode that is held near a size as ``held`` data would [-]."""

        def excess(size: float) -> float:
            left = self.square[:, mode] * self.now[:, mode] / (self.stated[:, mode] + size**2)
            return float(left.sum() - self.free[mode]) + held * ((near / size) ** 2 - 1)

        return _root(excess)


def _root(excess: Callable[[float], float]) -> float:
    """Return where a falling function of an error's size is 0, or the end of the range nearest to it [-]."""
    low, high = RANGE
    if excess(low) <= 0:
        return low
    if excess(high) >= 0:
        return high
    return float(np.exp(brentq(lambda log: excess(float(np.exp(log))), np.log(low), np.log(high), xtol=1e-4)))


def _parts(system: System, linear: Linear) -> list[_Part | None]:
    """Return what is left of each specimen's shapes; None of one without."""
    lever, parts, end = leverage(system, linear), list[_Part | None](), system.count_of_frequencies
    for specimen in system.specimens:
        test = specimen.measured
        if not test.has_shapes:
            parts.append(None)
            continue
        shape = test.constants.shape
        begin, end = end, end + test.constants.size
        free = shape[0] - (0 if specimen.level else 1) - lever[begin:end].reshape(shape).sum(axis=0)
        power = np.maximum(np.mean(test.constants**2, axis=0), 1e-300)
        bare = None if specimen.nominal.discrepancy is None else np.zeros(shape[1])
        stated = specimen.nominal.errors_with(bare).sigma.reshape(shape) ** 2 / power
        now = specimen.errors.sigma.reshape(shape) ** 2 / power
        square = linear.residual[begin:end].reshape(shape) ** 2
        guess = GUESSED_SHAPE_SIGMA if test.guessed else 0.0
        parts.append(_Part(square, np.maximum(free, 0.0), now, stated, guess))
    return parts
