"""Modal constants, or shapes: measured minus predicted, in units of each mode's r.m.s."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.close_modes import CloseModes
from updating.likelihood.comparison import Block
from updating.likelihood.hit_scatter import level_errors, own_variance
from updating.likelihood.missed_modes import MissedModes
from updating.likelihood.nodes import Nodes
from updating.likelihood.phase import Phases
from updating.likelihood.places import Places
from updating.likelihood.wide_beams import WideBeams
from updating.prediction.misplaced import best_levels
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
    def places(self) -> Places:
        """What is known of where points are."""
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

    @cached_property
    def _wide_beams(self) -> WideBeams:
        return WideBeams(self.setting)

    def block(self, view: View) -> Block:
        """Return the constants beside a state, the calibration a named doubt where their level is data."""
        test, now, names = self.setting.measured, view.now, len(self.setting.names)
        constants, by, missed = self._corrected(view)
        level = self._level(constants, view)
        predicted, by = constants * level, by * level[:, :, None]
        variance = self._known_errors if missed is None else self._known_errors + missed * level**2
        variance = variance + self._wide_beams.variance(now, level) + self.places.left_out(now, level)
        if view.state.delay:
            variance = variance + self._late(view.state.delay) ** 2
        by_place = self.places.columns(now, level, self._measured)
        own = [
            *by_place,
            self._nodes.columns(now, level),
            self._close_modes.columns(now, level),
            self._missed_modes.columns(now, level),
            self._wide_beams.columns(now, level),
        ]
        uneven = None
        if view.doubt.fidelity:
            uneven, louder = self._idealised(view, predicted)
            variance = variance + uneven
            own.append(louder)
        if view.doubt.uneven:
            own.append(self._close_modes.turned_by_doubt(view, level))
        gain = self._gains(predicted)
        if not test.absolute:
            own, gain = [gain, *own], np.zeros((predicted.size, 0))
        moved, ahead = self.places.movable, 0 if test.absolute else own[0].shape[1]
        residual = (self._measured - predicted).ravel()
        if len(view.places):
            residual = residual + np.hstack(by_place)[:, moved] @ view.places
        mode, source = self._labels
        return Block(
            channel="frf",
            residual=residual,
            variance=variance.ravel(),
            factors=by.reshape(predicted.size, names),
            named=gain,
            own=np.hstack(own),
            mode=mode,
            source=source,
            idealised=None if uneven is None else uneven.ravel(),
            unseen=self._unseen,
            places=ahead + moved,
        )

    @cached_property
    def _measured(self) -> FloatArray:
        """Measured constants over their r.m.s., (n_frf, n_modes) [-]."""
        return self.setting.measured.constants / self.scale

    @cached_property
    def _known_errors(self) -> FloatArray:
        """Variance of each constant that no state changes, (n_frf, n_modes) [-]."""
        return self._own / self.scale**2 + LEAST_CONSTANT_NOISE**2

    @cached_property
    def _labels(self) -> tuple[IntArray, IntArray]:
        """Mode and FRF of each datum, (n,) each."""
        frf, mode = np.indices(self._measured.shape)
        return mode.ravel(), frf.ravel()

    @cached_property
    def _unseen(self) -> FloatArray:
        """Variance of what no scatter shows, (n,) [-]."""
        return np.full(self._measured.size, LEAST_CONSTANT_NOISE**2)

    def _corrected(self, view: View) -> tuple[FloatArray, FloatArray, FloatArray | None]:
        """Return predicted constants and their sensitivities, what a baseline has determined included, and its
        variance, None without one.
        """
        now = view.now
        if self.setting.before is None:
            return now.constants, now.constants_by, None
        missed = self.setting.before.shapes(now, view.state)
        return now.constants + missed.constants, now.constants_by - missed.known, missed.variance

    def _level(self, constants: FloatArray, view: View) -> FloatArray:
        """Return what predicted constants are multiplied by: sign and scale, and where no level is known the best."""
        test, measured = self.setting.measured, self._measured
        level = test.same_signs(constants) / self.scale
        level = (
            self.phases.factor(view) * level if self.phases.present else np.tile(level, (len(constants), 1))
        )
        if not test.absolute:
            return np.asarray(level * best_levels(measured, constants * level))
        if test.calibration > UNKNOWN_LEVEL:
            return np.asarray(
                level * best_levels(measured.reshape(-1, 1), (constants * level).reshape(-1, 1))
            )
        return level

    def _late(self, delay: float) -> FloatArray:
        """Return the error that fitting a constant that is late by ``delay`` [s] makes, (n_modes,) [-]."""
        late = 2 * np.pi * self.setting.measured.frequency * abs(delay)
        return np.asarray(DELAY_FIT_ERROR * np.minimum(late, np.pi))

    def _idealised(self, view: View, predicted: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return variance and a column of doubt by how far a candidate's idealisation may be off.

        A change of the modes' levels errs as a whole, what is no mere change of level point by point. Gains of the
        measurement chain are no idealisation: where they counted, a gain of 0.12 was within a roving sensor's doubt.
        """
        exact, fidelity = view.unidealised(self.setting), view.doubt.fidelity
        chain = view.now.gain / exact.gain
        structure = predicted / chain
        before = exact.constants * self.setting.measured.same_signs(exact.constants) / self.scale
        share = best_levels(structure, before)
        uneven = fidelity * chain * (structure - share * before)
        return uneven**2, (fidelity * chain * (share - 1) * before).reshape(-1, 1)

    def _gains(self, predicted: FloatArray) -> FloatArray:
        """Return the gain of the whole test, or of each mode where only shapes are known."""
        if self.setting.measured.absolute:
            return (self.setting.measured.level_sigma * predicted).reshape(-1, 1)
        n = predicted.shape[1]
        return np.asarray((FREE_LEVEL_DOUBT * predicted[:, :, None] * np.eye(n)).reshape(-1, n))
