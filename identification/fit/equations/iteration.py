"""Steps of Gauss and Newton, damped by Levenberg and Marquardt, until they come to rest."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from identification.fit.equations.projection import Problem, State, Step, state_at

_RIDGE = 1e-14
_LONG = 4  # steps from which on as few combinations of FRFs as show the poles are worth forming


def settled(
    problem: Problem, state: State, iterations: int, tolerance: tuple[float, float]
) -> tuple[State, bool]:
    """Return where the steps come to rest, and whether they do, by as few combinations of FRFs as show the poles."""
    while True:
        few = problem.combined(state.products.cross) if iterations > _LONG else None
        if few is None:
            return _iterate(problem, state, iterations, tolerance)
        found, converged = _iterate(few, state_at(few, state.poles), iterations, tolerance)
        last, state = state, state_at(problem, found.poles)
        rest = max(tolerance[0] * state.cost, tolerance[1])
        if not converged or state.cost > last.cost - rest or _promise(state.step) < rest:
            return (state, converged) if state.cost <= last.cost else (last, converged)


def _promise(step: Step) -> float:
    """Return by how much the next step should lower the misfit [-]."""
    move = solved_step(step.normal, step.gradient, 0.0)
    return expected_gain(step.normal, step.gradient, move)


def _iterate(
    problem: Problem, state: State, iterations: int, tolerance: tuple[float, float]
) -> tuple[State, bool]:
    """Return where the steps come to rest, and whether they do."""
    damping = 1e-3
    for _ in range(iterations):
        rest = max(tolerance[0] * state.cost, tolerance[1])
        step = solved_step(state.step.normal, state.step.gradient, damping)
        promised = expected_gain(state.step.normal, state.step.gradient, step)
        trial_poles = state.poles + step[0::2] + 1j * step[1::2]
        trial = state_at(problem, decaying(trial_poles, state.poles, problem.axis.decay))
        if trial.cost <= state.cost:
            gain = state.cost - trial.cost
            state, damping = trial, max(0.1 * damping, 1e-12)
            if gain < rest:
                return state, True
        else:
            damping *= 10.0
            if damping > 1e8 or promised < rest:
                return state, True
    return state, False


def solved_step(normal: FloatArray, gradient: FloatArray, damping: float) -> FloatArray:
    """Return the step of Levenberg and Marquardt in unit columns, shape as ``gradient``."""
    diagonal = np.diag(normal)
    length = np.sqrt(np.maximum(diagonal, 1e-24 * diagonal.max() + 1e-200))
    unit = normal / np.outer(length, length) + (damping + _RIDGE) * np.eye(len(length))
    return np.asarray(np.linalg.solve(unit, gradient / length) / length)


def expected_gain(normal: FloatArray, gradient: FloatArray, step: FloatArray) -> float:
    """Return by how much a step lowers the misfit where the model is linear [-]."""
    return float(step @ (2.0 * gradient - normal @ step))


def decaying(trial: ComplexArray, poles: ComplexArray, decay: float) -> ComplexArray:
    """Keep trial poles decaying and Im > 0; go half-way to a border that would be crossed."""
    real = np.where(trial.real < decay, trial.real, 0.5 * (poles.real + decay))
    imag = np.where(trial.imag > 0.5 * poles.imag, trial.imag, 0.75 * poles.imag)
    return np.asarray(real + 1j * imag)
