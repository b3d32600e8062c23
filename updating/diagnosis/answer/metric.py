"""In which terms a gap is stated: the error of frequencies, of damping, of the FRFs, or of all data together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.answer.closing import Metric
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import gaussian
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import DAMPING_REPEATABILITY, UNSTATED_DAMPING_NOISE

TOLD_AS: dict[str, Metric] = {
    "frequency": "frequency",
    "damping": "damping",
    "frf": "frf",
    "phase": "frf",
    "level": "combined",
    "trend": "combined",
}
"""The metric of each channel: phases are of the FRFs; the dependence on force and on time has no error of its own."""


def metric_of(
    nothing: Comparison, left: Comparison, scale: float, *, rules: DecisionRules = DEFAULT_RULES
) -> Metric:
    """Return the metric of the channel that carries the gap, or ``combined`` where two carry it.

    Shapes come last. With a noise of their own, which may be many times as large, they surprise nobody, and with that
    which an explanation leaves they do with every change of the structure: they carry what no other channel shows.

    Parameters
    ----------
    nothing : Comparison
        Of the nominal model, its doubts at the sizes that are most probable without a cause.
    left : Comparison
        The same with the noise that the best explanation leaves.
    scale : float
        That of the noise of the shapes [-].
    rules : DecisionRules
        What the answer is decided by: what chance shows a gap, and how much another channel carries of it.
    """
    surprise = {}
    for name, metric in TOLD_AS.items():
        one, own = (left, scale) if metric == "frf" else (nothing, 1.0)
        keep = one.of(name)
        if keep.any():
            misfit = gaussian(one, (own,), keep).fit.chi2
            surprise[name] = float(chi2.logsf(misfit[0, 0, 0], int(keep.sum())))
    others = {name: value for name, value in surprise.items() if TOLD_AS[name] != "frf"}
    if min(others.values(), default=0.0) < np.log(rules.significant_gap):
        surprise = others
    order = sorted(surprise, key=lambda name: surprise[name])
    if not order:
        return "frequency"
    stated = [TOLD_AS[name] for name in order if surprise[name] <= rules.second_metric * surprise[order[0]]]
    return stated[0] if len(set(stated)) == 1 else "combined"


@dataclass(frozen=True, eq=False)
class Squares:
    """Errors by mode: their sum of squares and how many they are.

    Parameters
    ----------
    total : (n_modes,) array
        Sum of squares of each mode [-].
    count : (n_modes,) array
        Number of data of each mode.
    """

    total: FloatArray
    count: FloatArray

    @property
    def mean(self) -> float:
        """Mean square [-]."""
        return float(self.total.sum() / max(self.count.sum(), 1.0))

    @property
    def rms(self) -> float:
        """R.m.s. [-]."""
        return float(np.sqrt(self.mean))


def squares(
    residual: FloatArray, nominal: Comparison, metric: Metric, *, odd: BoolArray | None = None
) -> Squares:
    """Return the errors that residuals mean in a metric.

    Parameters
    ----------
    residual : (n,) array
        Measured minus predicted data [-].
    nominal : Comparison
        The nominal model's, for channels, modes and noise.
    metric : str
        ``frequency`` and ``damping``: relative error of the model; ``frf``: error of the complex modal constants
        over their r.m.s. in the mode; ``combined``: every datum over its standard deviation.
    odd : (n,) bool array, optional
        Data that count nowhere; left out, none.
    """
    count = int(nominal.mode.max()) + 1
    kept = np.ones(len(residual), dtype=bool) if odd is None else ~odd
    if metric == "combined":
        error, counted = residual / np.sqrt(nominal.variance), nominal.of_pairs
    elif metric == "frf":
        # a mode turned by a small angle is off by that angle in all its constants
        counted, turned = nominal.of("frf"), nominal.of("phase")
        share = np.sqrt(counted.sum() / max(turned.sum(), 1))
        error = np.where(counted, residual, np.where(turned, share * residual, 0.0))
    else:
        counted = nominal.of(metric)
        error = np.where(counted, np.expm1(-np.where(counted, residual, 0.0)), 0.0)
    paired = nominal.of_pairs
    mode, square, present = (part[paired] for part in (nominal.mode, kept * error**2, kept & counted))
    return Squares(
        np.asarray(np.bincount(mode, square, minlength=count), dtype=float),
        np.asarray(np.bincount(mode, present.astype(float), minlength=count), dtype=float),
    )


def noise_squares(
    specimens: tuple[SpecimenProblem, ...],
    nominal: Comparison,
    metric: Metric,
    *,
    odd: BoolArray | None = None,
) -> Squares:
    """Return the errors that repeating the test, and the baseline, alone would give.

    Parameters
    ----------
    specimens : tuple of Problem
        The specimens.
    nominal : Comparison
        The nominal model's.
    metric, odd
        As in :func:`squares`.
    """
    if metric == "combined":
        return squares(np.sqrt(nominal.variance), nominal, metric, odd=odd)
    variance = np.array(nominal.variance)
    rows = nominal.of("frequency")
    variance[rows] = np.concatenate([_repeated(one) for one in specimens])
    rows = nominal.of("damping")
    variance[rows] = np.concatenate([_damped(one) for one in specimens])
    small = np.sqrt(np.maximum(variance, 0.0))
    # of small errors relative and logarithmic are the same
    return squares(-np.log1p(small) if metric != "frf" else small, nominal, metric, odd=odd)


def _damped(problem: SpecimenProblem) -> FloatArray:
    """Return the variance of ln zeta from one mounting to the next, per mode whose damping is known [-]."""
    test, rows = problem.measured, problem.damping_known
    relative = np.nan_to_num(test.damping_sigma[rows] / test.damping[rows], nan=UNSTATED_DAMPING_NOISE)
    return np.asarray(relative**2 + DAMPING_REPEATABILITY**2)


def _repeated(problem: SpecimenProblem) -> FloatArray:
    """Return the variance of ln f that repeating the test (and the baseline) gives, per mode [-]."""
    tests = [problem.measured] + ([] if problem.baseline is None else [problem.baseline])
    noise = [np.mean((t.frequency_sigma / t.frequency) ** 2) + t.repeatability**2 for t in tests]
    return np.full(len(problem.measured.frequency), sum(noise))
