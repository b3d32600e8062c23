"""Modes that are close: what scatters their frequencies turns their shapes into each other.

A change dK that the model does not know has elements between modes as large as those on the diagonal, which shift the
frequencies. These scatter by a relative s, so a shape takes up of another one by 1 sigma 2 s f_i f_j / (f_j^2 - f_i^2)
(perturbation of first order, as of Fox and Kapoor, AIAA Journal 6, 2426, 1968): of modes 1 % apart that scatter by
0.05 %, 5 % of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Setting
from updating.prediction.predict import Prediction
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
        before = self.setting.nominal
        columns = np.zeros((*level.shape, len(angle)))
        every = np.arange(len(angle))
        for mode, other, turn in ((first, second, angle), (second, first, -angle)):
            change = self._change(now, mode, other)
            columns[:, mode, every] = turn * level[:, mode] * change
        # shapes have no sign of their own: a column that leaps would be no smooth function of the state
        alike = np.sum(self._change(now, first, second) * self._change(before, first, second), axis=0)
        return np.asarray(np.where(alike < 0, -1.0, 1.0) * columns).reshape(level.size, len(angle))

    def _change(self, now: Prediction, mode: IntArray, other: IntArray) -> FloatArray:
        """Return what constants of modes change by as others are added to their shapes, (n_frf, k) [1/kg]."""
        test, shape = self.setting.measured, now.at_points
        bare = (test.hit < 0)[:, None]
        seen, hit = shape[test.seen], np.where(bare, 1.0, shape[test.hit])
        added = seen[:, other] * hit[:, mode] + np.where(bare, 0.0, seen[:, mode] * hit[:, other])
        return np.asarray(now.gain[:, mode] * added)

    @cached_property
    def _pairs(self) -> tuple[IntArray, FloatArray]:
        """Return the pairs (2, k) of modes that are close enough, and by how much they turn, (k,) [rad]."""
        test = self.setting.measured
        i, j = np.triu_indices(len(test.frequency), 1)
        scatter = test.repeatability**2 + self.further
        far = np.abs(test.frequency[j] ** 2 - test.frequency[i] ** 2)
        together = test.frequency[i] * test.frequency[j]
        angle = 2 * np.sqrt((scatter[i] + scatter[j]) / 2) * together / np.maximum(far, 1e-12 * together)
        shows = angle > LEAST_TURN
        return np.stack([i, j])[:, shows], np.minimum(angle[shows], 1.0)
