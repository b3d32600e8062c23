"""Errors mode by mode before and after the best explanation, in the channel that carries the gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating import LIBRARY, Case, Diagnosis
from updating.diagnosis.candidate import Candidate
from updating.diagnosis.comparison import CHANNELS, Comparison
from updating.diagnosis.diagnose import pose
from updating.diagnosis.gaussian import Marginal, marginal
from updating.diagnosis.problem import Problem
from updating.diagnosis.result import Ranked
from updating.models.state import State, combine

LABELS = {
    "frequency": "model − test, of the frequency [%]",
    "damping": "model − test, of the damping ratio [%]",
    "frf": "r.m.s. misfit of the modal constants [%]",
}


@dataclass(frozen=True, eq=False)
class ModeErrors:
    """Errors of each mode.

    Parameters
    ----------
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    before, after : (n_modes,) arrays
        Errors of the nominal model and of the best explanation [%]; ``after`` may be None.
    floor, doubt : (n_modes,) arrays
        Two standard deviations of the noise, and of noise and tolerances together [%]; ``doubt`` may be None.
    channel : str
        frequency, damping or frf.
    """

    frequency: FloatArray
    before: FloatArray
    after: FloatArray | None
    floor: FloatArray
    doubt: FloatArray | None
    channel: str

    @property
    def label(self) -> str:
        """Of the axis, with its unit."""
        return LABELS[self.channel]


def mode_errors(diagnosis: Diagnosis, case: Case | None = None) -> ModeErrors:
    """Return the errors of each mode.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case, optional
        What was diagnosed. Without it only the frequency errors of the nominal model are known.
    """
    if case is None:
        modes = diagnosis.gap.modes
        test, before, sigma = (modes[n].to_numpy(float) for n in ("test [Hz]", "error [%]", "sigma [%]"))
        return ModeErrors(test, before, None, 2 * sigma, None, "frequency")
    problem, _ = pose(case)
    metric = diagnosis.shrink.metric if diagnosis.shrink.metric in CHANNELS else "frequency"
    plain = problem.compare(State())
    rows = plain.channel == CHANNELS.index(metric)
    if not rows.any():
        return mode_errors(diagnosis)
    variance = plain.variance[rows] - (problem.tolerances.damping**2 if metric == "damping" else 0.0)
    count, modes_of = len(problem.measured.frequency), plain.mode[rows]
    floor = 200 * np.sqrt(_mean(np.maximum(variance, 0.0), modes_of, count))
    total = plain.variance[rows] + np.sum(plain.nuisance[rows] ** 2, axis=1)
    doubt = 200 * np.sqrt(_mean(total, modes_of, count))
    left_over = _left_over(problem, diagnosis)
    after = None if left_over is None else _errors(left_over[rows], modes_of, count, metric)
    before = _errors(plain.residual[rows], modes_of, count, metric)
    return ModeErrors(problem.measured.frequency, before, after, floor, doubt, metric)


def _errors(residual: FloatArray, mode: FloatArray, count: int, metric: str) -> FloatArray:
    """Return the signed error of each mode, or its r.m.s. where a mode has several data [%]."""
    if metric == "frf":
        return 100 * np.sqrt(_mean(residual**2, mode, count))
    return 100 * np.expm1(-_mean(residual, mode, count))


def _mean(values: FloatArray, mode: FloatArray, count: int) -> FloatArray:
    """Average over the data of each mode; nan where it has none."""
    size = np.bincount(mode, minlength=count)
    return np.asarray(np.where(size > 0, np.bincount(mode, values, count) / np.maximum(size, 1), np.nan))


def _left_over(problem: Problem, diagnosis: Diagnosis) -> FloatArray | None:
    """Return the residual after the best explanation, and the tolerances most probable under it."""
    leader = diagnosis.ranking[0] if diagnosis.ranking and diagnosis.verdict != "none" else None
    if leader is None or any(name not in LIBRARY for name in leader.effects):
        return None
    theories = [None, "timoshenko"] if problem.predictor.spec.kind == "beam" else [None]
    fits = [_fit(problem, Candidate(tuple(LIBRARY[n] for n in leader.effects), t), leader) for t in theories]  # type: ignore[arg-type]
    comparison, result = max(fits, key=lambda fit: fit[1].log_likelihood)
    return np.asarray(comparison.residual - comparison.nuisance @ result.shift)


def _fit(problem: Problem, candidate: Candidate, leader: Ranked) -> tuple[Comparison, Marginal]:
    stage = candidate.stage(problem.predictor)
    states = []
    for effect in candidate.effects:
        values = {
            p.name: leader.parameters[f"{effect.name}.{p.name}"].value for p in effect.parameters(stage)
        }
        states.append(effect.state(stage, values))
    state = combine([*states, State(theory=candidate.theory)])
    comparison = problem.compare(state, doubt=candidate.doubt)
    result = marginal(comparison)
    for _ in range(2 if problem.wide else 0):
        comparison = problem.compare(state, result.shift[: len(problem.names)], doubt=candidate.doubt)
        result = marginal(comparison)
    return comparison, result
