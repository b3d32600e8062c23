"""What to measure next: hypothetical tests, and how far each would drive the remaining explanations apart.

For each test the leading explanation predicts its outcome; the separation from a rival is the Mahalanobis
distance that is left when the rival's parameters and all nuisances have done their best, together with the
data there are already.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.comparison import Comparison
from updating.diagnosis.evidence import Explanation
from updating.diagnosis.fit import sensitivities
from updating.diagnosis.posed import Posed
from updating.diagnosis.problem import Problem
from updating.diagnosis.result import NextTest
from updating.diagnosis.search import Search
from updating.effects.base import total_mass
from updating.models.state import State
from updating.prediction import Predictor

KNOWN_MASS = 0.05
"""Mass to add, relative to the structure's [-]."""

CALIBRATED = 0.005
"""What a calibration with a known mass reaches [-]."""

WORTH = 1.0
"""Separations below so many sigma are not worth a line."""


@dataclass(frozen=True)
class _Trial:
    measure: str
    apply: Callable[[Problem], Problem]
    extra: Callable[[Predictor], State] | None = None


def propose(posed: Posed, found: Search, sets: tuple[tuple[str, ...], ...]) -> tuple[NextTest, ...]:
    """Return the tests that would separate what is left, the most telling first.

    Parameters
    ----------
    posed : Problem or Several
        Test and model.
    found : Search
        What was weighed.
    sets : tuple of tuple of str
        Sets of effects of the answer; with fewer than two there is nothing to separate.
    """
    if len(sets) < 2 or len(posed.specimens) > 1:
        return ()
    problem = posed.specimens[0]
    rows = {row.names: row.explanation for row in found.weighed}
    rivals = [rows[names] for names in sets[:4]]
    tests = []
    for trial in _trials(problem):
        then = trial.apply(problem)
        for first, second in combinations(rivals, 2):
            gained = _separation(problem, then, trial, first, second)
            if gained >= WORTH:
                apart = tuple(dict.fromkeys(first.names + second.names))
                tests.append(NextTest(trial.measure, apart, round(gained, 1)))
    tests.sort(key=lambda test: -test.expected_sigma)
    best: dict[tuple[str, ...], NextTest] = {}
    for test in tests:
        best.setdefault((test.measure, *test.separates), test)
    return tuple(list(best.values())[:6])


def _trials(problem: Problem) -> list[_Trial]:
    """Return the tests that this specimen admits."""
    trials = []
    measured, predictor = problem.measured, problem.predictor
    if measured.absolute and measured.calibration > 2 * CALIBRATED:
        chain = f"calibrate the measurement chain with a known free mass, to {100 * CALIBRATED:g} %"
        trials.append(_Trial(chain, _calibrated))
    if len(measured.points):
        mass = KNOWN_MASS * total_mass(predictor.spec)
        for point in _two_points(problem):
            measure = f"repeat with a weighed mass of {1000 * mass:.3g} g at point {measured.nodes[point]}"
            trials.append(_Trial(measure, _unchanged, _added(mass, point)))
    trials.append(_Trial("weigh the specimen and measure its thickness, to 0.1 %", _weighed))
    return trials


def _added(mass: float, point: int) -> Callable[[Predictor], State]:
    def build(predictor: Predictor) -> State:
        row = predictor.nominal_rows["w"][[point]]
        return State(mass=(mass * row.T @ row,))

    return build


def _unchanged(problem: Problem) -> Problem:
    return problem


def _calibrated(problem: Problem) -> Problem:
    return replace(problem, measured=replace(problem.measured, calibration=CALIBRATED))


def _weighed(problem: Problem) -> Problem:
    return problem


def _two_points(problem: Problem) -> list[int]:
    """Return the point that moves most over the modes, and the one that moves least alike."""
    vectors = problem.nominal.vectors
    shapes = np.abs(problem.predictor.nominal_rows["w"][:, : len(vectors)] @ vectors)
    relative = shapes / np.maximum(shapes.max(axis=0), 1e-300)
    first = int(np.argmax(relative.sum(axis=1)))
    second = int(np.argmax(relative.std(axis=1)))
    return list(dict.fromkeys([first, second]))


def _separation(now: Problem, then: Problem, trial: _Trial, a: Explanation, b: Explanation) -> float:
    """Return by how many sigma a test would tell two explanations apart [-]."""
    if trial.apply is _weighed:
        return _weighing(a, b, now)
    blocks = [_difference(then, a, b, None)]
    if trial.extra is not None:
        blocks.append(_difference(then, a, b, trial.extra))
    difference = np.concatenate([block[0] for block in blocks])
    columns = np.vstack([block[1] for block in blocks])
    variance = np.concatenate([block[2] for block in blocks])
    prior = np.concatenate([np.ones(blocks[0][3]), np.full(columns.shape[1] - blocks[0][3], 1e-8)])
    inner = np.diag(prior) + (columns.T / variance) @ columns
    load = (columns.T / variance) @ difference
    left = float(difference @ (difference / variance) - load @ np.linalg.solve(inner, load))
    return float(np.sqrt(max(left, 0.0)))


def _difference(
    problem: Problem, a: Explanation, b: Explanation, extra: Callable[[Predictor], State] | None
) -> tuple[FloatArray, FloatArray, FloatArray, int]:
    """Return predictions of a minus b, what may absorb it, the noise, and the number of nuisances."""
    there: list[Comparison] = []
    for explanation in (a, b):
        state = explanation.candidate.state(problem.predictor, explanation.best.coordinates.tolist())
        if extra is not None:
            state = state.plus(extra(explanation.candidate.stage(problem.predictor)))
        there.append(problem.compare(state, doubt=explanation.candidate.doubt))
    free = sensitivities(problem, b.candidate, b.best)
    columns = np.hstack([there[1].nuisance, free])
    return there[1].residual - there[0].residual, columns, there[1].variance, there[1].nuisance.shape[1]


def _weighing(a: Explanation, b: Explanation, problem: Problem) -> float:
    """Return how far two explanations differ in mass per area and thickness, in units of 0.1 %."""
    predictor: Predictor = problem.predictor
    apart = []
    for name in ("density", "thickness"):
        values = []
        for explanation in (a, b):
            state = explanation.candidate.state(predictor, explanation.best.coordinates.tolist())
            values.append(np.log(state.factors.get(name, 1.0)))
        doubt = np.hypot(1e-3, problem.tolerances.factors.get(name, 0.0))
        apart.append((values[0] - values[1]) / doubt)
    return float(np.linalg.norm(apart))
