"""Which modes, bands and kinds of data carry the gap: each against the doubt it is held in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.linalg import cho_factor, cho_solve
from scipy.stats import chi2 as chi_square

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import bare_hertz, hertz, number
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.likelihood.comparison import Comparison
from updating.models.state import NOMINAL

NAMES = {
    "frequency": "frequency",
    "damping": "damping",
    "frf": "shape and level",
    "phase": "phase",
    "level": "change with force",
    "trend": "change over the test",
}
"""How the kinds of data are called."""


@dataclass(frozen=True, eq=False)
class Contributions:
    """What every mode adds to the gap.

    Parameters
    ----------
    modes : DataFrame
        One row per paired mode: test frequency [Hz], and for each kind of data how far model and test are apart in
        standard deviations of noise and tolerances together: signed, test over model, for frequency and damping, the
        root mean square for what holds several values; ``share [%]`` of the squared distance of all.
    summary : str
        One sentence on the worst band.
    """

    modes: pd.DataFrame
    summary: str


def contributions(problem: DiagnosisProblem, comparison: Comparison | None = None) -> Contributions:
    """Return what every mode adds to the gap between the test and the unchanged model.

    Parameters
    ----------
    problem : Problem or Several
        Test and model.
    comparison : Comparison, optional
        A comparison in place of that with the nominal model: what is left after an effect, for instance.
    """
    plain = problem.compare(NOMINAL) if comparison is None else comparison
    covariance = np.diag(plain.variance) + plain.nuisance @ plain.nuisance.T
    frequency = np.concatenate([one.measured.frequency for one in problem.specimens])
    count = len(frequency)
    kinds = [name for name in NAMES if plain.of(name).any()]
    misfit = {NAMES[name]: np.full(count, np.nan) for name in kinds}
    excess, squared = np.zeros((count, len(kinds))), np.zeros(count)
    for k, kind in enumerate(kinds):
        for mode in range(count):
            rows = np.flatnonzero(plain.of(kind) & (plain.mode == mode))
            if len(rows):
                distance = _distance(plain.residual[rows], covariance[np.ix_(rows, rows)])
                sign = np.sign(plain.residual[rows[0]]) if len(rows) == 1 else 1.0
                misfit[NAMES[kind]][mode] = sign * np.sqrt(distance / len(rows))
                excess[mode, k] = _sigmas(distance, len(rows))
                squared[mode] += distance
    table = pd.DataFrame(
        {
            "test [Hz]": frequency,
            **{f"{name} [sigma]": values for name, values in misfit.items()},
            "share [%]": 100 * squared / max(float(squared.sum()), 1e-300),
        },
        index=pd.RangeIndex(1, count + 1, name="mode"),
    )
    return Contributions(table, _sentence(frequency, excess, [NAMES[name] for name in kinds]))


def columns_of(modes: pd.DataFrame) -> dict[str, str]:
    """Return the kinds of data that a table of contributions holds, each with its column."""
    columns = {name: f"{name} [sigma]" for name in NAMES.values()}
    return {name: column for name, column in columns.items() if column in modes.columns}


def _distance(residual: FloatArray, covariance: FloatArray) -> float:
    return float(residual @ cho_solve(cho_factor(covariance), residual))


def _sigmas(distance: float, count: int) -> float:
    """Return how many sigma of one normal variate are as improbable as a squared distance of ``count`` data."""
    log_tail = float(chi_square.logsf(distance, count))
    if log_tail < -600:  # beyond the range of numbers: the tails of both are alike
        return float(np.sqrt(distance))
    return float(np.sqrt(chi_square.isf(np.exp(log_tail), 1)))


def _sentence(frequency: FloatArray, excess: FloatArray, names: list[str], *, notable: float = 3.0) -> str:
    """State which kind of data of which modes is the furthest off.

    From ``notable`` standard deviations on a mode carries some of the gap: of twenty modes one in eighteen tests has
    one by chance.
    """
    if not excess.size or excess.max() < notable:
        return "No mode stands out: all deviations are within noise and tolerances."
    worst = int(np.argmax(excess.max(axis=0)))
    column = excess[:, worst]
    order = np.argsort(frequency)
    band = _band(column[order], max(notable, 0.5 * float(column.max())))
    modes = order[band]
    at = frequency[modes]
    what = names[worst]
    if len(modes) == len(frequency) > 1:
        which = f"of all {len(frequency)} modes"
    elif len(modes) == 1:
        which = f"of mode {modes[0] + 1} ({hertz(at[0])})"
    else:
        which = f"of modes {modes[0] + 1} to {modes[-1] + 1} ({bare_hertz(at[0])} to {hertz(at[-1])})"
    return f"The gap is largest in the {what} {which}: up to {number(column.max())} sigma."


def _band(values: FloatArray, bar: float) -> IntArray:
    """Return the unbroken run about the largest value that stays above a bar."""
    top = int(np.argmax(values))
    low = high = top
    while low > 0 and values[low - 1] >= bar:
        low -= 1
    while high < len(values) - 1 and values[high + 1] >= bar:
        high += 1
    return np.arange(low, high + 1)
