"""Modal constants, or shapes: measured minus predicted, in units of each mode's r.m.s."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.baseline_prior import Missed
from updating.likelihood.close_modes import CloseModes
from updating.likelihood.comparison import Block
from updating.likelihood.hit_scatter import level_errors, own_variance
from updating.likelihood.missed_modes import MissedModes
from updating.likelihood.nodes import Nodes
from updating.likelihood.phase import Phases
from updating.likelihood.places import Places
from updating.test_data.measured import UNKNOWN_LEVEL, Measured
from updating.thresholds import (
    DELAY_FIT_ERROR,
    FREE_LEVEL_DOUBT,
    LEAST_CONSTANT_NOISE,
    REPEATED_SCATTER_PRIOR,
    SINGLE_SCATTER_PRIOR,
)


def scatter_prior(test: Measured) -> tuple[float, ...]:
    """Return the prior of each of ``SCALES`` on the noise of a test's constants [-]."""
    return REPEATED_SCATTER_PRIOR if test.repeated else SINGLE_SCATTER_PRIOR


@dataclass(frozen=True, eq=False)
class Constants(Quantity):
    """Modal constants of all FRFs, or components of shapes.

    Parameters
    ----------
    setting : Setting
        Test and model.
    phases : Phases
        The phases of the same constants, which say how a delay turns them.
    further : (n_modes,) array
        Variance of ln f that is no noise of the test [-].
    """

    phases: Phases
    further: FloatArray

    @property
    def present(self) -> bool:
        """Whether the test has such data."""
        return self.setting.measured.has_shapes

    @cached_property
    def scale(self) -> FloatArray:
        """R.m.s. of the measured constants of each mode [1/kg]."""
        test = self.setting.measured
        if not len(test.seen):
            return np.ones(len(test.frequency))
        return np.asarray(np.sqrt(np.mean(test.constants**2, axis=0)))

    @cached_property
    def _own(self) -> FloatArray:
        """Variance of each measured constant that no other shares, (n_frf, n_modes) [1/kg^2]."""
        test, scatter = self.setting.measured, self.setting.scatter
        if self._nodes.present:
            return own_variance(test, scatter)
        return own_variance(test, scatter) + (level_errors(test, scatter) * test.constants) ** 2

    @cached_property
    def _places(self) -> Places:
        return Places(self.setting)

    @cached_property
    def _nodes(self) -> Nodes:
        return Nodes(self.setting)

    @cached_property
    def _close_modes(self) -> CloseModes:
        return CloseModes(self.setting, self.further)

    @cached_property
    def _missed_modes(self) -> MissedModes:
        return MissedModes(self.setting)

    def block(self, view: View) -> Block:
        """Return the constants beside a state, the calibration a named doubt where their level is data."""
        test, now, scale = self.setting.measured, view.now, self.scale
        constants, by, missed = self._corrected(view)
        level = self._level(constants, view)
        predicted, by = constants * level, by * level[:, :, None]
        own_errors = self._own / scale**2 + missed.variance * level**2 + LEAST_CONSTANT_NOISE**2
        variance = own_errors + self._late(view) ** 2
        uneven, louder = self._idealised(predicted, view.doubt.fidelity)
        own = [
            *self._places.columns(now, level, test.constants / scale),
            self._nodes.columns(now, level),
            self._close_modes.columns(now, level),
            self._missed_modes.columns(now, level),
            louder,
        ]
        gain = self._gains(predicted)
        if not test.absolute:
            own, gain = [gain, *own], np.zeros((predicted.size, 0))
        return Block(
            "frf",
            (test.constants / scale - predicted).ravel(),
            (variance + uneven).ravel(),
            by.reshape(predicted.size, len(self.setting.names)),
            gain,
            np.hstack(own),
            np.broadcast_to(np.arange(predicted.shape[1]), predicted.shape).ravel(),
            np.repeat(np.arange(len(predicted)), predicted.shape[1]),
            uneven.ravel() if view.doubt.fidelity else None,
            unseen=np.full(predicted.size, LEAST_CONSTANT_NOISE**2),
        )

    def _corrected(self, view: View) -> tuple[FloatArray, FloatArray, Missed]:
        """Return predicted constants and their sensitivities, what a baseline has determined included, and what that
        is.
        """
        now = view.now
        if self.setting.before is None:
            nothing = np.zeros_like(now.constants)
            return now.constants, now.constants_by, Missed(nothing, nothing, now.constants_by)
        missed = self.setting.before.shapes(now, view.state)
        return now.constants + missed.constants, now.constants_by - missed.known, missed

    def _level(self, constants: FloatArray, view: View) -> FloatArray:
        """Return what predicted constants are multiplied by: sign and scale, and where no level is known the best."""
        test, scale = self.setting.measured, self.scale
        signs = self.phases.factor(view) if self.phases.present else np.broadcast_to(1.0, constants.shape)
        level = signs * test.same_signs(constants) / scale
        if not test.absolute:
            return np.asarray(level * _projection(test.constants / scale, constants * level, axis=0))
        if test.calibration > UNKNOWN_LEVEL:
            return np.asarray(
                level * float(_projection(test.constants / scale, constants * level, axis=None))
            )
        return np.asarray(level)

    def _late(self, view: View) -> FloatArray:
        """Return the error that fitting a delayed constant makes, (n_modes,) [-]."""
        late = 2 * np.pi * self.setting.measured.frequency * abs(view.state.delay)
        return np.asarray(DELAY_FIT_ERROR * np.minimum(late, np.pi))

    def _idealised(self, predicted: FloatArray, fidelity: float) -> tuple[FloatArray, FloatArray]:
        """Return variance and a column of doubt by how far a candidate's idealisation may be off.

        A change of the modes' levels errs as a whole, what is no mere change of level point by point.
        """
        if not fidelity:
            return np.zeros_like(predicted), np.zeros((predicted.size, 0))
        nominal = self.setting.nominal.constants
        before = nominal * self.setting.measured.same_signs(nominal) / self.scale
        share = _projection(predicted, before, axis=0)
        return (fidelity * (predicted - share * before)) ** 2, (fidelity * (share - 1) * before).reshape(
            -1, 1
        )

    def _gains(self, predicted: FloatArray) -> FloatArray:
        """Return the gain of the whole test, or of each mode where only shapes are known."""
        if self.setting.measured.absolute:
            return (self.setting.measured.level_sigma * predicted).reshape(-1, 1)
        n = predicted.shape[1]
        return np.asarray((FREE_LEVEL_DOUBT * predicted[:, :, None] * np.eye(n)).reshape(-1, n))


def _projection(data: FloatArray, model: FloatArray, *, axis: int | None) -> FloatArray:
    """Return the factor on the model that fits the data best, per column or over all."""
    power = np.maximum(np.sum(model**2, axis=axis), 1e-300)
    return np.asarray(np.sum(data * model, axis=axis) / power)
