"""Errors mode by mode before and after the best explanation, in the channel that carries the gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.quantities import hertz
from modalkit.workflow.fitted import Fitted, fitted
from updating import Case, Diagnosis
from updating.diagnosis.answer.metric import noise_squares, squares
from updating.likelihood.comparison import Comparison
from updating.models.state import State

LABELS = {
    "frequency": "model − test, of the frequency [%]",
    "damping": "model − test, of the damping ratio [%]",
    "frf": "r.m.s. misfit of the modal constants [%]",
    "combined": "r.m.s. error of all its data [σ]",
}


@dataclass(frozen=True, eq=False)
class ModeErrors:
    """Errors of each mode.

    Parameters
    ----------
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    before, after : (n_modes,) arrays
        Errors of the nominal model and of the best explanation, ``after`` may be None [%, or sigma if combined].
    floor, doubt : (n_modes,) arrays
        Two standard deviations of the noise, and of noise and tolerances together; either may be None [%].
    channel : str
        A key of ``LABELS``.
    modes : (n_modes,) int array, optional
        Numbers of the modes; left out, they are counted from 1.
    """

    frequency: FloatArray
    before: FloatArray
    after: FloatArray | None
    floor: FloatArray | None
    doubt: FloatArray | None
    channel: str
    modes: IntArray | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Number and frequency of each mode."""
        numbers = np.arange(1, len(self.frequency) + 1) if self.modes is None else self.modes
        return tuple(f"{i}: {hertz(f)}" for i, f in zip(numbers.tolist(), self.frequency, strict=True))

    @property
    def label(self) -> str:
        """Of the axis, with its unit."""
        return LABELS[self.channel]

    @property
    def signed(self) -> bool:
        """Whether the errors have a sign."""
        return self.channel in ("frequency", "damping")


def mode_errors(diagnosis: Diagnosis, case: Case | None = None, *, best: Fitted | None = None) -> ModeErrors:
    """Return the errors of each mode.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case, optional
        What was diagnosed. Without it only the frequency errors of the nominal model are known.
    best : Fitted, optional
        Its best explanation, where that is known already.
    """
    if case is None:
        modes = diagnosis.gap.modes
        test, before, sigma = (modes[n].to_numpy(float) for n in ("test [Hz]", "error [%]", "sigma [%]"))
        return ModeErrors(test, before, None, 2 * sigma, None, "frequency")
    found = fitted(diagnosis, case) if best is None else best
    problem = found.problem
    metric = diagnosis.shrink.metric if diagnosis.shrink.metric in LABELS else "frequency"
    plain, left_over = problem.compare(State()), found.left_over
    if metric == "combined":
        both = [_sigmas(plain, residual) for residual in (plain.residual, left_over) if residual is not None]
        return ModeErrors(problem.measured.frequency, both[0], (*both, None)[1], None, None, metric)
    rows = plain.of(metric)
    if not rows.any():
        return mode_errors(diagnosis)
    count, modes_of = len(problem.measured.frequency), plain.mode[rows]
    noise = noise_squares(problem.specimens, plain, metric)
    floor = 200 * np.sqrt(noise.total / np.maximum(noise.count, 1.0))
    total = plain.variance[rows] + np.sum(plain.nuisance[rows] ** 2, axis=1)
    doubt = 200 * np.sqrt(_mean(total, modes_of, count))
    after = None if left_over is None else _errors(left_over[rows], modes_of, count, metric)
    before = _errors(plain.residual[rows], modes_of, count, metric)
    return ModeErrors(problem.measured.frequency, before, after, floor, doubt, metric)


def _sigmas(plain: Comparison, residual: FloatArray) -> FloatArray:
    """Return the r.m.s. of all data of each mode [standard deviations]."""
    stated = squares(residual, plain, "combined")
    return np.asarray(np.sqrt(stated.total / np.maximum(stated.count, 1.0)))


def _errors(residual: FloatArray, mode: IntArray, count: int, metric: str) -> FloatArray:
    """Return the signed error of each mode, or its r.m.s. where a mode has several data [%]."""
    if metric == "frf":
        return 100 * np.sqrt(_mean(residual**2, mode, count))
    return 100 * np.expm1(-_mean(residual, mode, count))


def _mean(values: FloatArray, mode: IntArray, count: int) -> FloatArray:
    """Average over the data of each mode; nan where it has none."""
    size = np.bincount(mode, minlength=count)
    return np.asarray(np.where(size > 0, np.bincount(mode, values, count) / np.maximum(size, 1), np.nan))
