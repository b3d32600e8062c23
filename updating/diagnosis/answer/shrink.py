"""How far the gap shrinks, on the data that were fitted and on modes and points held out in turn."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.answer.closing import Closed, HeldPoints, Metric, Shrink
from updating.diagnosis.answer.metric import Squares, metric_of, noise_squares, squares
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.held_out import believed, modes_held_out, points_held_out
from updating.likelihood.comparison import Comparison
from updating.likelihood.outliers import with_outliers
from updating.problem.candidate import Candidate


def shrinkage(
    problem: DiagnosisProblem,
    nothing: Explanation,
    best: Explanation,
    runner_up: Explanation | None,
    rng: np.random.Generator,
    *,
    rules: DecisionRules = DEFAULT_RULES,
) -> Shrink:
    """Compare the gap before and after.

    Before is the nominal model, no tolerance moved. In all that comes after, tolerances, calibration and
    the level of damping are refitted, too. Where they are refitted alone, none is taken further than is believed of
    it: they would else close any gap that moves all modes alike, by an absurd modulus.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    nothing, best, runner_up : Explanation
        The nominal model with its tolerances, the best explanation, and the one behind it.
    rng : Generator
        For the bootstrap.
    rules : DecisionRules
        What the answer is decided by.
    """
    outliers, left = best.candidate.outliers, best.best.marginal
    plain = problem.at(Candidate(), np.zeros(0))
    start = with_outliers(problem.at(Candidate(), np.zeros(0), nothing.best.about), outliers)
    own = with_outliers(nothing.best.comparison, outliers)
    metric = metric_of(own, left.settle(start), left.scale, rules=rules)
    odd = _unexplained(best, plain)

    def counted(residual: FloatArray) -> Squares:
        return squares(residual, plain, metric, odd=odd)

    def held(explanation: Explanation) -> Squares:
        return counted(modes_held_out(problem, explanation))

    before, after = counted(plain.residual), held(best)
    alone = best.best.comparison if not best.names else None
    fitted = best.best.left_over if alone is None else believed(alone, best.best.marginal.scale)
    floor = noise_squares(problem.specimens, plain, metric, odd=odd)
    return Shrink(
        metric=metric,
        before=100 * before.rms,
        after=100 * counted(fitted).rms,
        held_before=100 * before.rms,
        held_after=100 * after.rms,
        held_runner_up=None if runner_up is None else 100 * held(runner_up).rms,
        held_nuisance=100 * held(nothing).rms,
        floor=100 * floor.rms,
        closed=closed(before, after, floor, rng, rules=rules),
        stretch=_stretch(nothing),
        points=_points(problem, nothing, best, plain, metric),
        aside=odd is not None,
    )


def _unexplained(best: Explanation, plain: Comparison) -> BoolArray | None:
    """Return which data count nowhere, (n,): what the best takes to be worse than stated, and does not explain either.

    A channel whose gain is off may be noisier, too: its gap is closed where half of its square is.
    """
    groups = [outlier.data(plain) for outlier in best.candidate.outliers]
    squares_left = best.best.left_over**2
    open_ = [rows for rows in groups if squares_left[rows].sum() > 0.5 * np.sum(plain.residual[rows] ** 2)]
    return np.any(open_, axis=0) if open_ else None


def _stretch(nothing: Explanation) -> float:
    """Return by how much the tolerances alone would have to be off to explain the data best [sigma]."""
    shift = nothing.best.marginal.shift[nothing.best.comparison.doubts]
    return float(np.abs(shift).max(initial=0.0))


def _points(
    problem: DiagnosisProblem, nothing: Explanation, best: Explanation, plain: Comparison, metric: Metric
) -> HeldPoints | None:
    """Return the errors of the modal constants at points held out; None where another metric measures the gap.

    What a channel does at its point no other point shows: such a cause is not tried so.
    """
    if metric not in {"frf", "combined"} or any(effect.labels for effect in best.candidate.effects):
        return None
    after, alone = points_held_out(problem, best), points_held_out(problem, nothing)
    if after is None or alone is None:
        return None
    errors = [
        100 * squares(np.where(after[1], residual, 0.0), plain, "frf").rms
        for residual in (plain.residual, after[0], alone[0])
    ]
    return HeldPoints(*errors)


def closed(
    before: Squares,
    after: Squares,
    floor: Squares,
    rng: np.random.Generator,
    *,
    draws: int = 400,
    rules: DecisionRules = DEFAULT_RULES,
) -> Closed | None:
    """Return the share of the closable gap that closes, with a bootstrap over modes and over the test's scatter.

    Parameters
    ----------
    before, after, floor : Squares
        Errors of the nominal model, on modes held out, and those of a test repeated.
    rng : Generator
        Draws the modes anew, and of each the errors that hitting again would add.
    draws : int
        How many: of 400 ten lie beyond each end of the interval.
    rules : DecisionRules
        What the answer is decided by.
    """
    if before.rms < rules.closable_gap * floor.rms or not np.isfinite(after.rms):
        return None
    value = _share(before, after, floor, np.arange(len(before.count)))
    drawn = [_drawn(before, after, floor, rng) for _ in range(draws)]
    low, high = np.nanpercentile(drawn, [2.5, 97.5])
    value = min(value, 100.0)
    ends = float(min(low, value)), float(max(min(high, 100.0), value))
    return Closed(value, *ends, nearly_all=rules.closes_nearly_all)


def _share(before: Squares, after: Squares, floor: Squares, modes: np.ndarray) -> float:
    count = max(before.count[modes].sum(), 1.0)
    b, a, s = (part.total[modes].sum() / count for part in (before, after, floor))
    return float(100 * (1 - (a - s) / (b - s))) if b > s else np.nan


def _drawn(before: Squares, after: Squares, floor: Squares, rng: np.random.Generator) -> float:
    """Return the share for modes drawn with replacement, their errors after scattered as the noise has it."""
    modes = rng.choice(len(before.count), len(before.count))
    size = np.sqrt(after.total[modes])
    noise = np.sqrt(floor.total[modes] / np.maximum(floor.count[modes], 1.0))
    scattered = (size + noise * rng.standard_normal(len(modes))) ** 2 - noise**2
    count = max(before.count[modes].sum(), 1.0)
    b, s = before.total[modes].sum() / count, floor.total[modes].sum() / count
    return float(100 * (1 - (scattered.sum() / count - s) / (b - s))) if b > s else np.nan
