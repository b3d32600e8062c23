"""Modes that are close: what scatters their frequencies turns their shapes into each other.

A change dK that the model lacks has elements between modes as large as those on the diagonal, which shift the
frequencies. These scatter by a relative s, so a shape takes up of another one by 1 sigma 2 s f_i f_j / (f_j^2 - f_i^2)
(perturbation of first order, as of Fox and Kapoor, AIAA Journal 6, 2426, 1968): of modes 1 % apart that scatter by
0.05 %, 5 % of it. So it does of a mode that the test has not, because its sensor sits at a node of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.prediction.prediction import Prediction
from updating.thresholds import LEAST_TURN


@dataclass(frozen=True, eq=False)
class CloseModes:
    """Nuisances of shapes that turn into each other, one of each pair of modes.

    Parameters
    ----------
    setting : Setting
        Test and model.
    further : (n_modes,) array
        Variance of ln f that is no noise of the test [-].
    """

    setting: Setting
    further: FloatArray

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-].

        Parameters
        ----------
        now : Prediction
            The modes.
        level : (n_frf, n_modes) array
            What predicted constants are multiplied by [kg].
        """
        (first, second), angle = self._pairs
        before, count = self.setting.nominal, level.shape[1]
        columns = np.zeros((*level.shape, len(angle)))
        for mode, other, turn in ((first, second, angle), (second, first, -angle)):
            seen = np.flatnonzero(mode < count)
            change = self._change(now, mode[seen], other[seen])
            columns[:, mode[seen], seen] = turn[seen] * level[:, mode[seen]] * change
        # shapes have no sign of their own: a column that leaps would be no smooth function of the state
        alike = np.sum(self._change(now, first, second) * self._change(before, first, second), axis=0)
        return np.asarray(np.where(alike < 0, -1.0, 1.0) * columns).reshape(level.size, len(angle))

    def _change(self, now: Prediction, mode: IntArray, other: IntArray) -> FloatArray:
        """Return what constants of modes change by as others are added to their shapes, (n_frf, k) [1/kg]."""
        lost = self.setting.missed
        seen, hit = np.hstack([now.seen, lost.seen])[:, other], np.hstack([now.hit, lost.hit])[:, other]
        return taken_up(now.select(mode), seen, hit, self.setting.measured.hit < 0)

    @cached_property
    def _pairs(self) -> tuple[IntArray, FloatArray]:
        """Return pairs (2, k) of modes that are close enough, and by how much they turn, (k,) [rad].

        The first is measured; so is the second, or it counts on as one that the test misses.
        """
        test, before, lost = self.setting.measured, self.setting.nominal, self.setting.missed.frequency
        count = len(test.frequency)
        i, j = np.triu_indices(count, 1, count + len(lost))
        both = j < count
        # how far a missed mode is from another one is known from the model only, for both
        f = np.where(both, test.frequency[i], before.frequency[i])
        g = np.concatenate([test.frequency, lost])[j]
        scatter = np.concatenate([test.repeatability**2 + self.further, np.zeros(len(lost))])
        mean = np.where(both, (scatter[i] + scatter[j]) / 2, scatter[i])
        angle = turn(f, g, np.sqrt(mean))
        shows = angle > LEAST_TURN
        return np.stack([i, j])[:, shows], angle[shows]


def turn(f: FloatArray, g: FloatArray, scatter: FloatArray) -> FloatArray:
    """Return how much modes of f [Hz] take up of others of g [Hz] whose frequencies scatter so far, relative [rad]."""
    far = np.abs(g**2 - f**2)
    return np.minimum(2 * scatter * f * g / np.maximum(far, 1e-12 * f * g), 1.0)


def taken_up(now: Prediction, seen: FloatArray, hit: FloatArray, bare: BoolArray) -> FloatArray:
    """Return what constants of modes change by as others are added to their shapes, (n_frf, k) [1/kg].

    Parameters
    ----------
    now : Prediction
        The k modes.
    seen, hit : (n_frf, k) arrays
        The others' shapes at the points seen and hit [1/sqrt(kg)].
    bare : (n_frf,) bool array
        Where a constant is a shape and has no point that is hit.
    """
    return np.asarray(now.gain * (seen * now.hit + now.seen * np.where(bare[:, None], 0.0, hit)))
