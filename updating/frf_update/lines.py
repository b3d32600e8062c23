"""Which frequency lines to compare: few that carry the information of all.

Paper B chooses its updating frequencies without a systematic criterion. Here they are chosen one by one so that the
determinant of the information on the parameters grows most (D-optimal design; Fedorov 1972), on the unchanged model,
with the noise and the discrepancy counted: a peak that the model cannot follow is no information.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.frf_update.stage import Stage

CANDIDATES = 250
"""Fewest lines examined, spread evenly over the band."""

BESIDE = 4
"""Lines on either side of each measured resonance that are examined too."""

COUNT = 100
"""Lines chosen where the user states none."""


def choose_lines(
    stage: Stage, theta: FloatArray, discrepancy: float, lines: int | Sequence[float] | None
) -> IntArray:
    """Return the lines of a stage.

    Parameters
    ----------
    stage : Stage
        The stage on all lines.
    theta : (p,) array
        Coordinates at which the model is evaluated.
    discrepancy : float
        Relative discrepancy of the model [-].
    lines : int, sequence of float, optional
        How many, or which frequencies [Hz].

    Returns
    -------
    (n,) int array
        Numbers of the lines, rising.

    Raises
    ------
    StudyError
        If a frequency lies outside the band, or fewer than one line is asked for.
    """
    frequency = stage.frfs.frequency
    if lines is not None and not isinstance(lines, int):
        return _nearest(frequency, np.asarray(lines, dtype=float))
    count = COUNT if lines is None else lines
    if count < 1:
        raise StudyError(f"[update] lines = {count}: name at least one line, or leave it out")
    peaks = stage.all_resonances if stage.damps_alone else np.zeros(0)
    thin = _candidates(frequency, peaks, max(CANDIDATES, 2 * count))
    if count >= len(thin):
        return thin
    few = stage.lines(thin)
    return np.sort(thin[_greedy(_information(few, theta, discrepancy), count)])


def _candidates(frequency: FloatArray, resonances: FloatArray, count: int) -> IntArray:
    """Return lines spread evenly over the band, and those about some resonances, which an even spread may miss.

    Where damping alone is asked for it stands there. Of mass and stiffness a line right on a peak is most informative
    if the model can follow it, and misleads most if not.
    """
    even = np.round(np.linspace(0, len(frequency) - 1, min(count, len(frequency)))).astype(int)
    nearest = np.abs(frequency[:, None] - resonances).argmin(axis=0)
    about = nearest[:, None] + np.arange(-BESIDE, BESIDE + 1)
    return np.unique(np.clip(np.concatenate([even, about.ravel()]), 0, len(frequency) - 1))


def _nearest(frequency: FloatArray, wanted: FloatArray) -> IntArray:
    step = float(np.median(np.diff(frequency)))
    outside = (wanted < frequency[0] - step) | (wanted > frequency[-1] + step)
    if outside.any() or not len(wanted):
        raise StudyError(
            f"[update] lines: {wanted[outside][:1].tolist() or 'an empty list'} Hz is outside the band "
            f"from {frequency[0]:g} to {frequency[-1]:g} Hz"
        )
    return np.unique(np.abs(frequency[:, None] - wanted).argmin(axis=0))


def _information(stage: Stage, theta: FloatArray, discrepancy: float) -> FloatArray:
    """Return the information of every line on the parameters, in units of their doubts, (n_lines, p, p) [-]."""
    at = stage.evaluate(theta)
    slopes = stage.slopes(theta, at, measured=False) * stage.doubt[:, None, None]
    weight = 2 / stage.variance(at, discrepancy)
    both = np.einsum("pfl,qfl,fl->lpq", slopes, slopes.conj(), weight, optimize=True)
    return np.asarray(both.real)


def _greedy(information: FloatArray, count: int) -> IntArray:
    """Take the line that raises the determinant most, again and again; prior information is one of each doubt."""
    total = np.eye(information.shape[1])
    left = np.ones(len(information), dtype=bool)
    chosen = []
    for _ in range(count):
        gain = np.linalg.slogdet(total + information)[1]
        best = int(np.argmax(np.where(left, gain, -np.inf)))
        chosen.append(best)
        left[best] = False
        total = total + information[best]
    return np.array(chosen)
