"""Modes that a test has and the nominal model lacks: known to a state that has them, and any mode to all others.

The same data stand beside every state, or their evidence could not be compared. Beside a state without the mode its
frequency and damping may be any, and its shape is a mixture of those of the model's modes next to it: it is a twin of
one of them, a mode of what the structure hangs on, or in a direction that the model leaves out. What the mode adds to
the evidence of a state that has it is that it was right.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import stats
from scipy.linalg import block_diag

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.close_modes import taken_up, turn
from updating.likelihood.comparison import Block
from updating.likelihood.phase import Phases
from updating.models.absorbers import swinging
from updating.prediction.prediction import Prediction
from updating.test_data.measured import UNKNOWN_LEVEL, Measured
from updating.thresholds import (
    DAMPING_REPEATABILITY,
    FREE_LEVEL_DOUBT,
    LEAST_DAMPING,
    LEAST_FREQUENCY_NOISE,
    LEAST_TURN,
    UNPAIRED_NEIGHBOURS,
    UNPAIRED_SHAPE_NOISE,
    UNPAIRED_SPREAD,
    UNSTATED_DAMPING_NOISE,
)

NO_MODE = -1
"""Number of the paired mode that these data belong to: none."""


@dataclass(frozen=True, eq=False)
class _Rows:
    """The data of one mode: ln f, ln zeta where it counts, and the constants over their r.m.s.

    Parameters
    ----------
    residual, variance : (n,) arrays
        Measured minus expected, and the variance of the noise [-].
    factors : (n, n_names) array
        Change of what is expected per unit of what all data doubt alike [-].
    own : (n, UNPAIRED_NEIGHBOURS) array
        Change per standard deviation of nuisances of this mode alone: its level, and what it takes up of close modes;
        of one that is none in particular, shares of the modes next to it [-].
    idle : bool
        Whether the state does not predict it.
    idealised : float
        What of the variance of ln f a candidate's idealisation adds, at the most [-].
    """

    residual: FloatArray
    variance: FloatArray
    factors: FloatArray
    own: FloatArray
    idle: bool
    idealised: float = 0.0

    def log_likelihood(self, sigmas: FloatArray) -> float:
        """Return their log-likelihood by themselves, all that is doubted integrated out [-].

        ``sigmas`` are the standard deviations of what all data doubt alike.
        """
        columns = np.hstack([self.factors * sigmas, self.own])
        return float(
            stats.multivariate_normal(cov=np.diag(self.variance) + columns @ columns.T).logpdf(self.residual)
        )


def _channels(rows: _Rows, count: int) -> IntArray:
    """Return the measuring channel of each datum of a mode, -1 of its frequency and damping, (n,)."""
    return np.concatenate([np.full(len(rows.residual) - count, -1), np.arange(count)])


@dataclass(frozen=True, eq=False)
class UnpairedModes(Quantity):
    """Frequency, damping and modal constants of the modes that have no partner in the nominal model."""

    @property
    def present(self) -> bool:
        """Whether the test has such modes."""
        return self.setting.measured.unpaired is not None

    @property
    def _test(self) -> Measured:
        test = self.setting.measured.unpaired
        assert test is not None
        return test

    def block(self, view: View) -> Block:
        """Return each mode beside that of the state which it is; beside no mode in particular where it is none."""
        parts = [self._likeliest(view, i) for i in range(len(self._test.frequency))]
        count = sum(len(part.residual) for part in parts)
        return Block(
            channel="unpaired",
            residual=np.concatenate([part.residual for part in parts]),
            variance=np.concatenate([part.variance for part in parts]),
            factors=np.concatenate([part.factors for part in parts]),
            named=np.zeros((count, 0)),
            own=block_diag(*(part.own for part in parts)),
            mode=np.full(count, NO_MODE),
            source=np.concatenate([_channels(part, len(self._test.seen)) for part in parts]),
            idealised=np.concatenate([np.eye(1, len(part.residual))[0] * part.idealised for part in parts])
            if view.doubt.fidelity
            else None,
            idle=np.concatenate([np.full(len(part.residual), part.idle) for part in parts]),
        )

    def _likeliest(self, view: View, i: int) -> _Rows:
        """Return a mode beside that of a state which it is, which it may be if that is more probable, or any."""
        if view.whole is None:
            return self._any(i)
        if view.claims[i] >= 0:
            return self._known(view, view.whole, int(view.claims[i]), i)
        parts = [self._any(i)]
        if view.offers[i] >= 0:
            parts.append(self._known(view, view.whole, int(view.offers[i]), i))
        return max(parts, key=lambda part: part.log_likelihood(self.setting.sigmas))

    def _known(self, view: View, whole: Prediction, k: int, i: int) -> _Rows:
        """Return a mode beside the k-th of a state."""
        test, scale = self._test, self._scale[i]
        first, names = [np.log(test.frequency[i] / whole.frequency[k])], len(self.setting.names)
        relative = test.frequency_sigma[i] / test.frequency[i]
        idealised = self._idealised(view, i)
        variance = [relative**2 + max(test.repeatability, LEAST_FREQUENCY_NOISE) ** 2 + idealised]
        factors = [whole.log_frequency_by[k]]
        if self._damped[i]:
            first.append(np.log(test.damping[i] / max(whole.damping[k], LEAST_DAMPING)))
            doubts = (self.setting.tolerances.damping, view.doubt.damping)
            variance.append(self._damping_noise(i) + sum(doubt**2 for doubt in doubts))
            factors.append(np.zeros(names))
        signs = self._signs(replace(view, now=whole.select(np.array([k]))), i)
        measured, constants = test.constants[:, i] / scale, signs * whole.constants[:, k] / scale
        level, doubt = -1.0 if test.bare and measured @ constants < 0 else 1.0, test.level_sigma
        if not test.absolute or test.calibration > UNKNOWN_LEVEL:
            level = float(measured @ constants) / max(float(constants @ constants), 1e-300)
            doubt = FREE_LEVEL_DOUBT
        own = np.zeros((len(first) + len(measured), UNPAIRED_NEIGHBOURS))
        own[len(first) :, 0] = doubt * level * constants
        turned = self._turned(whole, k) * (level / scale)
        own[len(first) :, 1 : 1 + turned.shape[1]] = turned
        return _Rows(
            np.append(first, measured - level * constants),
            np.append(variance, self._shape_noise(i)),
            np.vstack([*factors, whole.constants_by[:, k] * (level * signs / scale)[:, None]]),
            own,
            idle=False,
            idealised=idealised,
        )

    def _turned(self, whole: Prediction, k: int) -> FloatArray:
        """Return what the k-th mode of a state takes up of its neighbours by 1 sigma, (n_frf, n_near) [1/kg]."""
        test, f = self._test, whole.frequency
        others = np.flatnonzero(np.arange(len(f)) != k)
        near = others[np.argsort(np.abs(np.log(f[others] / f[k])))[: UNPAIRED_NEIGHBOURS - 1]]
        angle = turn(f[near], f[[k]], np.asarray(test.repeatability))
        own = whole.gain[:, [k]], whole.seen[:, [k]], whole.hit[:, [k]]
        change = taken_up(*own, whole.seen[:, near], whole.hit[:, near], test.hit < 0)
        return np.asarray(np.where(angle > LEAST_TURN, angle, 0.0) * change)

    def _any(self, i: int) -> _Rows:
        """Return a mode beside no mode in particular."""
        test, paired, nominal = self._test, self.setting.measured, self.setting.nominal
        first = [np.log(test.frequency[i]) - np.mean(np.log(paired.frequency))]
        if self._damped[i]:
            first.append(np.log(test.damping[i]) - np.mean(np.log(self._known_dampings)))
        near = np.argsort(np.abs(np.log(nominal.frequency / test.frequency[i])))[:UNPAIRED_NEIGHBOURS]
        shapes = nominal.constants[:, near]
        own = np.zeros((len(first) + len(shapes), UNPAIRED_NEIGHBOURS))
        size = np.maximum(np.sqrt(np.mean(shapes**2, axis=0)), 1e-300)
        own[len(first) :, : len(near)] = UNPAIRED_SPREAD * shapes / size
        return _Rows(
            np.append(first, test.constants[:, i] / self._scale[i]),
            np.append(np.full(len(first), UNPAIRED_SPREAD**2), self._shape_noise(i)),
            np.zeros((len(own), len(self.setting.names))),
            own,
            idle=True,
        )

    def _idealised(self, view: View, i: int) -> float:
        """Return how far the idealisation of what makes a mode leaves its ln f off, relative to the shift it suffers.

        A mass on a spring is moved by the structure as far as it moves the structure: from where it swings alone. What
        changes a mode beyond recognition shifts it as far as it shifts any.
        """
        alone = [np.sqrt(one.stiffness / one.mass) / (2 * np.pi) for one in swinging(view.state.absorbers)]
        shifts = [abs(float(np.log(self._test.frequency[i] / own))) for own in alone]
        most = np.nan_to_num(
            np.abs(np.log(view.now.frequency / view.unidealised(self.setting).frequency))
        ).max(initial=0.0)
        return (view.doubt.fidelity * min(shifts, default=float(most))) ** 2

    def _signs(self, view: View, i: int) -> FloatArray:
        """Return what the phases of a mode's constants make of real ones, (n_frf,) [-]."""
        phases = Phases(replace(self.setting, measured=self._test.modes(np.array([i]))))
        return phases.factor(view)[:, 0] if phases.present else np.ones(len(self._test.seen))

    @cached_property
    def _scale(self) -> FloatArray:
        """R.m.s. of the constants of each mode [1/kg]."""
        return np.asarray(np.sqrt(np.mean(self._test.constants**2, axis=0)))

    @cached_property
    def _known_dampings(self) -> FloatArray:
        """Damping ratios of the paired modes whose damping is measured [-]; one of 0 is none."""
        measured = self.setting.measured.damping
        return measured[np.isfinite(measured) & (measured > 0)]

    @cached_property
    def _damped(self) -> BoolArray:
        """Whether the damping of each mode is measured, and some damping expected of the model."""
        known = self.setting.predictor.expects_damping and len(self._known_dampings) > 0
        return np.asarray((np.nan_to_num(self._test.damping) > 0) & known)

    def _damping_noise(self, i: int) -> float:
        relative = float(self._test.damping_sigma[i] / self._test.damping[i])
        return float(np.nan_to_num(relative, nan=UNSTATED_DAMPING_NOISE) ** 2 + DAMPING_REPEATABILITY**2)

    def _shape_noise(self, i: int) -> FloatArray:
        """Return the variance of the constants of one mode over their r.m.s., (n_frf,) [-]."""
        return np.asarray((self._test.constants_sigma[:, i] / self._scale[i]) ** 2 + UNPAIRED_SHAPE_NOISE**2)
