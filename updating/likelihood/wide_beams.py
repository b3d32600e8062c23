"""What shapes of a beam have across its width: clamps hold the section straight, and Poisson's ratio curves it.

No study states on which line across the width the points lie, and no theory of beams has a width. A plate of the same
outline has, see :mod:`updating.models.width`: so how far it moves beyond the beam is a doubt of the shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Nuisances
from updating.likelihood.close_modes import taken_up
from updating.models.width import across_width
from updating.prediction.prediction import Prediction
from updating.thresholds import BEYOND_PLATE


@dataclass(frozen=True, eq=False)
class WideBeams(Nuisances):
    """Nuisances of the mean over the section, and of the lines on which all points were seen, and were hit.

    One standard deviation is what the plate has on its middle line. A baseline was measured on the same lines.
    """

    @property
    def present(self) -> bool:
        """Whether the model is a beam whose sections curve, and no baseline shows by how much."""
        spec = self.setting.predictor.spec
        curved = spec.kind == "beam" and spec.material.poisson != 0 and len(self.setting.measured.seen) > 0
        return curved and self.setting.before is None

    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-]."""
        if not self.present:
            return np.zeros((level.size, 0))
        return np.moveaxis(self._changed(now, level), 0, -1).reshape(level.size, -1)

    def variance(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return what bricks have beyond the plate, near ends and edges above all, (n_frf, n_modes) [-]."""
        if not self.present:
            return np.zeros_like(level)
        return np.asarray(np.sum((BEYOND_PLATE * self._changed(now, level)) ** 2, axis=0))

    def _changed(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the changes of the nominal shapes at the level that the state gives them, (k, n_frf, n_modes) [-].

        What an effect changes of a shape changes a doubt of per cents by little. A gain, or the mass that a mode moves,
        changes all that is read of it.
        """
        before = self.setting.nominal
        gain = now.gain / before.gain
        power = np.maximum(np.sum(before.constants**2, axis=0), np.finfo(float).tiny)
        own = np.sum(now.constants / gain * before.constants, axis=0) / power
        return np.asarray(level * gain * own * self._changes)

    @cached_property
    def _changes(self) -> FloatArray:
        """What the nominal constants change by, (k, n_frf, n_modes) [1/kg]."""
        test, nominal = self.setting.measured, self.setting.nominal
        bare = test.hit < 0
        whole, line = self._beyond
        seen, hit = np.zeros((2, *nominal.seen.shape))
        pairs = [(whole[test.seen], whole[test.hit]), (line[test.seen], hit)]
        if not bare.all():
            pairs.append((seen, line[test.hit]))
        return np.stack([taken_up(nominal.gain, nominal.seen, nominal.hit, *pair, bare) for pair in pairs])

    @cached_property
    def _beyond(self) -> tuple[FloatArray, FloatArray]:
        """What the plate moves beyond the beam at the points, signs as nominal, (n_points, n_modes) each [kg^-1/2]."""
        test, nominal, base = self.setting.measured, self.setting.nominal, self.setting.predictor.base
        spec = self.setting.predictor.spec
        spec = spec if base.theory is None else spec.with_theory(base.theory)
        every = np.concatenate([nominal.frequency, self.setting.missed.frequency])
        order = np.searchsorted(np.sort(every), nominal.frequency)
        found = across_width(spec, order, test.points[:, 0])
        across = np.ones((len(test.points), 1)) if test.directions is None else test.directions[:, 2:]
        moved = np.zeros_like(found.shape)
        moved[test.seen] = nominal.seen
        sign = np.where(np.sum(moved * across * found.shape, axis=0) < 0, -1.0, 1.0)
        return across * sign * found.mean, across * sign * found.line
