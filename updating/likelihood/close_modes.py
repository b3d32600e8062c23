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
from updating.likelihood.base import Nuisances, View
from updating.prediction.prediction import Prediction
from updating.thresholds import LEAST_TURN


@dataclass(frozen=True, eq=False)
class CloseModes(Nuisances):
    """Nuisances of shapes that turn into each other, one of each pair of modes.

    Parameters
    ----------
    further : (n_modes,) array
        Variance of ln f that is no noise of the test [-].
    """

    further: FloatArray

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-]."""
        return self._turned(now, level, *self._pairs)

    def _turned(self, now: Prediction, level: FloatArray, pairs: IntArray, angle: FloatArray) -> FloatArray:
        """Return the change of the constants as pairs (2, k) of modes turn by an angle (k,) [rad]."""
        first, second = pairs
        columns = np.zeros((*level.shape, len(angle)))
        if not len(angle):
            return columns.reshape(level.size, 0)
        both = np.flatnonzero(second < level.shape[1])
        seen, hit = self._with_missed(now)
        change = self._change(now, first, seen[:, second], hit[:, second])
        columns[:, first, np.arange(len(angle))] = angle * level[:, first] * change
        i, j = first[both], second[both]
        columns[:, j, both] = -angle[both] * level[:, j] * self._change(now, j, now.seen[:, i], now.hit[:, i])
        # shapes have no sign of their own: a column that leaps would be no smooth function of the state
        seen, hit = self._with_missed(self.setting.nominal)
        before = self._change(self.setting.nominal, first, seen[:, second], hit[:, second])
        alike = np.sum(change * before, axis=0)
        return np.asarray(np.where(alike < 0, -1.0, 1.0) * columns).reshape(level.size, len(angle))

    def turned_by_doubt(self, view: View, level: FloatArray) -> FloatArray:
        """Return what an error of the idealisation, that differs from mode to mode, changes (n_frf n_modes, k) [-].

        A fluid that weighs a few per cent more on one mode than on the next mixes modes that it has brought together.
        Each pair turns as a whole: as variances of single constants such errors were worth hundreds of determinants.
        What a change that shifts both modes adds between them is at most the geometric mean of what it adds to each.
        """
        now, (i, j) = view.now, self._neighbours
        shift = view.doubt.uneven * np.log(now.frequency / view.unidealised(self.setting).frequency)
        doubt = np.sqrt(np.abs(shift[i] * shift[j]))
        return self._turned(now, level, np.stack([i, j]), turn(now.frequency[i], now.frequency[j], doubt))

    def _change(self, now: Prediction, mode: IntArray, seen: FloatArray, hit: FloatArray) -> FloatArray:
        """Return what constants of modes change by as others are added to their shapes, (n_frf, k) [1/kg]."""
        own = now.gain[:, mode], now.seen[:, mode], now.hit[:, mode]
        return taken_up(*own, seen, hit, self.setting.measured.hit < 0)

    def _with_missed(self, now: Prediction) -> tuple[FloatArray, FloatArray]:
        """Return shapes seen and hit of the measured modes and of those that the test misses, (n_frf, all) each."""
        lost = self.setting.missed
        return np.hstack([now.seen, lost.seen]), np.hstack([now.hit, lost.hit])

    @cached_property
    def _neighbours(self) -> tuple[IntArray, IntArray]:
        """Modes and the next ones in frequency, (k,) each."""
        order = np.argsort(self.setting.measured.frequency)
        return order[:-1], order[1:]

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


def taken_up(
    gain: FloatArray,
    own_seen: FloatArray,
    own_hit: FloatArray,
    seen: FloatArray,
    hit: FloatArray,
    bare: BoolArray,
) -> FloatArray:
    """Return what constants of modes change by as others are added to their shapes, (n_frf, k) [1/kg].

    Parameters
    ----------
    gain : (n_frf, k) array
        Of the k modes, constants over the product of shapes [-].
    own_seen, own_hit : (n_frf, k) arrays
        Their shapes at the points seen and hit [1/sqrt(kg)].
    seen, hit : (n_frf, k) arrays
        The others' shapes there [1/sqrt(kg)].
    bare : (n_frf,) bool array
        Where a constant is a shape and has no point that is hit.
    """
    return np.asarray(gain * (seen * own_hit + own_seen * np.where(bare[:, None], 0.0, hit)))
