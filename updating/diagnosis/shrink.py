"""How far the gap shrinks, on the data that were fitted and on modes held out in turn."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.candidate import Candidate
from updating.diagnosis.comparison import CHANNELS
from updating.diagnosis.evidence import Explanation
from updating.diagnosis.fit import climb, evaluate
from updating.diagnosis.goodness import carrier
from updating.diagnosis.posed import Posed
from updating.diagnosis.problem import Problem
from updating.diagnosis.result import Closed, Shrink


def shrinkage(
    problem: Posed,
    nothing: Explanation,
    best: Explanation,
    runner_up: Explanation | None,
    rng: np.random.Generator,
) -> Shrink:
    """Compare the gap before and after.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    nothing, best, runner_up : Explanation
        The nominal model with its tolerances, the best explanation, and the one behind it.
    rng : Generator
        For the bootstrap over modes.
    """
    metric = carrier(nothing.best)
    rows = nothing.best.comparison.channel == CHANNELS.index(metric)
    mode = nothing.best.comparison.mode[rows]
    raw = _relative(_raw(problem, metric), metric)
    fitted = _relative(best.best.left_over[rows], metric)
    floor = _rms(np.sqrt(_noise(problem, metric)))
    held = held_out(problem, best, metric)
    other = None if runner_up is None else held_out(problem, runner_up, metric)
    alone = held_out(
        problem, Explanation(Candidate(), 0.0, nothing.best, nothing.samples, nothing.weights), metric
    )
    return Shrink(
        metric,  # type: ignore[arg-type]
        100 * _rms(raw),
        100 * _rms(fitted),
        100 * _rms(raw),
        100 * _rms(held),
        None if other is None else 100 * _rms(other),
        100 * _rms(alone),
        100 * floor,
        _closed(raw, held, mode, floor, rng),
    )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else 0.0


def _raw(problem: Posed, metric: str) -> FloatArray:
    """Return the errors of the nominal model as it stands, no tolerance moved."""
    comparison = evaluate(problem, Candidate(), np.zeros(0)).comparison
    plain = problem.at(Candidate(), np.zeros(0))
    return np.asarray(plain.residual[comparison.channel == CHANNELS.index(metric)])


def _noise(problem: Posed, metric: str) -> FloatArray:
    """Return the variance that repeating the test (and the baseline) alone would give, per datum of a channel."""
    plain = problem.at(Candidate(), np.zeros(0))
    rows = plain.channel == CHANNELS.index(metric)
    if metric == "frequency":
        return np.concatenate([_repeated(one) for one in problem.specimens])
    variance = plain.variance[rows]
    if metric == "damping":
        doubts = [np.full(len(one.damping_known), one.damping_doubt) for one in problem.specimens]
        variance = variance - np.concatenate(doubts) ** 2
    return np.asarray(np.maximum(variance, 0.0))


def _repeated(problem: Problem) -> FloatArray:
    """Return the variance of ln f that repeating the test (and the baseline) gives, per mode [-]."""
    tests = [problem.measured] + ([] if problem.baseline is None else [problem.baseline])
    noise = [np.mean((t.frequency_sigma / t.frequency) ** 2) + t.repeatability**2 for t in tests]
    return np.full(len(problem.measured.frequency), sum(noise))


def held_out(problem: Posed, explanation: Explanation, metric: str) -> FloatArray:
    """Predict each mode from all others, and return the errors of the prediction [-].

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    explanation : Explanation
        What is refitted without each mode in turn, starting from its best parameters.
    metric : str
        Channel whose errors are returned.
    """
    mode = explanation.best.comparison.mode
    channel = explanation.best.comparison.channel == CHANNELS.index(metric)
    errors = np.zeros(len(mode))
    for left_out in np.unique(mode):
        keep = mode != left_out
        if not keep.any():
            continue
        start = explanation.best.coordinates
        point = climb(problem, explanation.candidate, start, keep=keep, rounds=4).point
        errors[~keep] = point.left_over[~keep]
    return _relative(errors[channel], metric)


def _relative(residual: FloatArray, metric: str) -> FloatArray:
    """Take logarithmic residuals, test over model, to relative errors of the model [-]."""
    return np.asarray(residual if metric == "frf" else np.exp(-residual) - 1)


def _closed(
    before: FloatArray, after: FloatArray, mode: np.ndarray, floor: float, rng: np.random.Generator
) -> Closed | None:
    """Return the share of the closable gap that closes, with a bootstrap over the modes."""
    if _rms(before) < 1.5 * floor:
        return None

    def share(b: FloatArray, a: FloatArray) -> float:
        closable = np.mean(b**2) - floor**2
        return float(100 * (1 - (np.mean(a**2) - floor**2) / closable)) if closable > 0 else np.nan

    modes = np.unique(mode)
    draws = []
    for _ in range(400):
        drawn = np.concatenate([np.flatnonzero(mode == m) for m in rng.choice(modes, len(modes))])
        draws.append(share(before[drawn], after[drawn]))
    low, high = np.nanpercentile(draws, [2.5, 97.5])
    value = min(share(before, after), 100.0)
    return Closed(value, float(min(low, value)), float(max(min(high, 100.0), value)))
