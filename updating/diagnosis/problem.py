"""The comparison of one test with one state of the model: residuals, nuisances and noise.

Every doubt that is not an effect is a *nuisance*: a column of sensitivities with a standard normal prior.
They are the modeller's tolerances, the calibration, the common level of damping, and where each point was
really hit. What is left is independent noise: the identification's covariance, re-mounting scatter, the
scatter of damping from mode to mode, and how far an effect's own idealisation may be off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.diagnosis.before import Before
from updating.effects.base import Effect
from updating.matching import match
from updating.measured import Measured
from updating.models.base import FACTORS
from updating.models.state import State
from updating.prediction import Prediction, Predictor
from updating.tolerances import Tolerances

SHAPE_FLOOR = 0.005
"""Error of a modal constant that no coherence shows (cross-talk, direction), relative to the mode's r.m.s."""

SCALES = (1.0, 2.0, 4.0, 8.0, 16.0)
"""How many times worse than thought the shapes may be."""

KNOWN_SCATTER = (0.85, 0.12, 0.025, 0.004, 0.001)
UNKNOWN_SCATTER = (0.3, 0.25, 0.2, 0.15, 0.1)
"""Prior of each scale, where repeated hits show the scatter and where nothing does."""

REPEATED_DAMPING = 0.1
"""Scatter of damping from one mounting of a specimen to the next, relative [-]."""

LEAST_NOISE = 1e-6
"""No frequency is known better than this, relative [-]."""

UNKNOWN_LEVEL = 0.2
"""A calibration worse than this is found by least squares before anything is linearised."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Measured minus predicted data at one state, with what may explain it.

    Parameters
    ----------
    residual : (n,) array
        ln f, then ln damping ratio, then modal constants over their r.m.s. per mode [-].
    nuisance : (n, p) array
        Change of the prediction per standard deviation of each nuisance [-].
    variance : (n,) array
        Variance of the independent noise [-].
    channel : (n,) int array
        0 frequency, 1 damping, 2 shape and level.
    mode : (n,) int array
        Measured mode each datum belongs to.
    prediction : Prediction
        The predicted modes, in the order of the measured ones.
    scale_prior : tuple of float
        Prior of each of ``SCALES`` on the noise of the shapes [-].
    doubts : int
        How many of the first nuisances are named doubts: tolerances, level of damping, calibration.
    """

    residual: FloatArray
    nuisance: FloatArray
    variance: FloatArray
    channel: IntArray
    mode: IntArray
    prediction: Prediction
    scale_prior: tuple[float, ...] = KNOWN_SCATTER
    doubts: int = 0

    def noise(self, scale: float) -> FloatArray:
        """Return the variance with the shapes so many times worse than thought, shape (n,) [-]."""
        return np.where(self.channel == 2, scale**2, 1.0) * self.variance


@dataclass(frozen=True, eq=False)
class Problem:
    """A test, a model, and all that is doubted about either.

    Parameters
    ----------
    predictor : Predictor
        The model as seen from the test's points, a baseline's correction included.
    measured : Measured
        The test, with the modes that have a partner.
    tolerances : Tolerances
        The modeller's doubts.
    order : (n_modes,) int array
        Rank of the model mode of each measured mode, for data without shapes.
    baseline : Measured, optional
        Modes of the same specimen before the effect; its correction is in the predictor.
    baseline_order : (n_baseline,) int array, optional
        Rank of the model mode of each of them, for data without shapes.
    accepted : tuple of Effect
        Effects put into the model beforehand, the first of the predictor's additions.
    """

    predictor: Predictor
    measured: Measured
    tolerances: Tolerances
    order: IntArray
    baseline: Measured | None = None
    baseline_order: IntArray | None = None
    accepted: tuple[Effect, ...] = ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Factors with a tolerance that the model knows."""
        known = {name for term in self.predictor.reduced.structure.terms for name in term.powers}
        return tuple(n for n in FACTORS if n in known and self.tolerances.factors.get(n, 0.0) > 0)

    @property
    def reach(self) -> int:
        """How many of the model's modes a match may need."""
        return int(self.order.max()) + 3

    @cached_property
    def before(self) -> Before | None:
        """What the baseline has already said."""
        if self.baseline is None or self.baseline_order is None:
            return None
        return Before(self.predictor, self.measured, self.baseline, self.baseline_order, self.names)

    @property
    def damping_doubt(self) -> float:
        """Doubt in the expected damping: a baseline that measured it knows better than a modeller [-]."""
        told = self.tolerances.damping
        return min(told, REPEATED_DAMPING) if self.baseline is not None else told

    @cached_property
    def sigmas(self) -> FloatArray:
        """Their standard deviations [-]."""
        return np.array([self.tolerances.factors[n] for n in self.names])

    @cached_property
    def scale(self) -> FloatArray:
        """R.m.s. of the measured constants of each mode [1/kg]."""
        if not len(self.measured.seen):
            return np.ones(len(self.measured.frequency))
        return np.asarray(np.sqrt(np.mean(self.measured.constants**2, axis=0)))

    @cached_property
    def damping_known(self) -> IntArray:
        """Rows of modes whose damping is measured and expected."""
        finite = np.isfinite(self.measured.damping) & (self.measured.damping > 0)
        known = finite if self.predictor.expects_damping else np.zeros_like(finite)
        return np.asarray(np.flatnonzero(known), dtype=np.int64)

    @cached_property
    def nominal(self) -> Prediction:
        """The nominal prediction of the matched modes."""
        prediction = self.predictor.predict(factors=self.names, at_least=self.reach)
        return prediction.select(match(self.measured, prediction, self.order))

    @property
    def wide(self) -> bool:
        """Whether tolerances are too wide for one linearisation."""
        return bool(len(self.sigmas)) and float(self.sigmas.max()) > 0.04

    def compare(self, state: State, shift: FloatArray | None = None, *, fidelity: float = 0.0) -> Comparison:
        """Compare the test with a state of the model.

        Parameters
        ----------
        state : State
            Departure from the nominal model.
        shift : (n_names,) array, optional
            Tolerance nuisances applied to the model before it is linearised [standard deviations].
        fidelity : float
            How far the state's idealisation may be off, relative to the shift it makes [-].
        """
        shift = np.zeros(len(self.names)) if shift is None else shift
        moved = State(factors=dict(zip(self.names, np.exp(shift * self.sigmas), strict=True)))
        prediction = self.predictor.predict(state.plus(moved), factors=self.names, at_least=self.reach)
        prediction = prediction.select(match(self.measured, prediction, self.order))
        reference = self.nominal if fidelity else None
        blocks = [self._frequencies(prediction, reference, fidelity), self._dampings(prediction)]
        if self.measured.has_shapes:
            blocks.append(self._shapes(prediction, reference, fidelity))
        return self._assemble(blocks, shift, prediction)

    def _assemble(self, blocks: list[_Block], shift: FloatArray, prediction: Prediction) -> Comparison:
        columns = sum(b.own.shape[1] for b in blocks) + len(self.names)
        rows = sum(len(b.residual) for b in blocks)
        nuisance = np.zeros((rows, columns))
        row, column = 0, len(self.names)
        for block in blocks:
            end, right = row + len(block.residual), column + block.own.shape[1]
            nuisance[row:end, : len(self.names)] = block.factors * self.sigmas
            nuisance[row:end, column:right] = block.own
            row, column = end, right
        residual = np.concatenate([b.residual for b in blocks])
        residual = residual + nuisance[:, : len(self.names)] @ shift
        channel = np.concatenate([np.full(len(b.residual), i) for i, b in enumerate(blocks)])
        return Comparison(
            residual,
            nuisance,
            np.concatenate([b.variance for b in blocks]),
            channel,
            np.concatenate([b.mode for b in blocks]),
            prediction,
            KNOWN_SCATTER if self.measured.repeated else UNKNOWN_SCATTER,
            len(self.names)
            + blocks[0].own.shape[1]
            + blocks[1].own.shape[1]
            + int(self.measured.absolute and len(blocks) > 2),
        )

    def _frequencies(self, now: Prediction, reference: Prediction | None, fidelity: float) -> _Block:
        test = self.measured
        variance = (test.frequency_sigma / test.frequency) ** 2 + max(test.repeatability, LEAST_NOISE) ** 2
        by = now.log_frequency_by
        if self.before is not None:
            doubt, known = self.before.frequency(now)
            variance, by = variance + doubt, by - known
        variance = variance + self._accepted_variance
        n = len(test.frequency)
        own = np.zeros((n, 0))
        if reference is not None:
            # an idealisation errs in the size of the whole shift, and again in each mode
            doubtful = fidelity * np.log(now.frequency / reference.frequency)
            variance, own = variance + doubtful**2, doubtful[:, None]
        return _Block(np.log(test.frequency / now.frequency), by, own, variance, np.arange(n))

    @cached_property
    def _accepted_variance(self) -> FloatArray:
        """How far the idealisations of the effects put into the model beforehand may be off, relative [-]."""
        if not self.doubt_of_accepted:
            return np.zeros(len(self.measured.frequency))
        without = self.predictor.looking(self.measured, self.predictor.additions[len(self.accepted) :])
        plain = without.predict(at_least=self.reach)
        plain = plain.select(match(self.measured, plain, self.order))
        shift = np.log(self.nominal.frequency / plain.frequency)
        return np.asarray((self.doubt_of_accepted * shift) ** 2)

    @property
    def doubt_of_accepted(self) -> float:
        """Largest fidelity of the effects put into the model beforehand [-]."""
        return max((effect.fidelity for effect in self.accepted), default=0.0)

    def _damping_tolerance(self, now: Prediction) -> FloatArray:
        """Return the doubt in the expected damping of each mode: small where a baseline measured it [-]."""
        told = self.tolerances.damping
        if self.before is None:
            return np.full(len(now.frequency), told)
        return np.where(self.before.seen(now) > 0.5, self.damping_doubt, told)

    def _dampings(self, now: Prediction) -> _Block:
        rows = self.damping_known
        test = self.measured
        relative = np.nan_to_num(test.damping_sigma[rows] / test.damping[rows], nan=0.05)
        expected = np.maximum(now.damping[rows], 1e-7)
        tolerance = self._damping_tolerance(now)[rows]
        variance = relative**2 + tolerance**2
        return _Block(
            np.log(test.damping[rows] / expected),
            np.zeros((len(rows), len(self.names))),
            tolerance[:, None] if len(rows) else np.zeros((0, 0)),
            variance,
            rows,
        )

    def _shapes(self, now: Prediction, reference: Prediction | None, fidelity: float) -> _Block:
        test, scale = self.measured, self.scale
        constants, by, doubt = now.constants, now.constants_by, np.zeros_like(now.constants)
        if self.before is not None:
            missed, doubt, known = self.before.shapes(now)
            constants, by = constants + missed, by - known
        predicted, by, along = constants / scale, by / scale[:, None], now.along / scale
        along_scale: FloatArray | float | None = None
        if not test.absolute:
            share = _projection(test.constants / scale, predicted, axis=0)
            predicted, by, along = predicted * share, by * share[:, None], along * share
            along_scale = share
        elif test.calibration > UNKNOWN_LEVEL:
            level = float(_projection(test.constants / scale, predicted, axis=None))
            predicted, by, along = predicted * level, by * level, along * level
            along_scale = level
        variance = (test.constants_sigma**2 + doubt) / scale**2 + SHAPE_FLOOR**2
        if reference is not None:
            # the part of the change that is not a mere change of the mode's level
            before = reference.constants / scale
            before = before * _projection(predicted, before, axis=0)
            variance = variance + (fidelity * (predicted - before)) ** 2
        sensors = now.along_seen / scale * (along_scale if along_scale is not None else 1.0)
        own = [self._level_columns(predicted), self._position_columns(along), self._sensor_columns(sensors)]
        modes = np.broadcast_to(np.arange(predicted.shape[1]), predicted.shape).ravel()
        return _Block(
            (test.constants / scale - predicted).ravel(),
            by.reshape(predicted.size, len(self.names)),
            np.hstack(own),
            variance.ravel(),
            modes,
        )

    def _level_columns(self, predicted: FloatArray) -> FloatArray:
        """Return the gain of the whole test, or of each mode where only shapes are known."""
        if self.measured.absolute:
            return (self.measured.calibration * predicted).reshape(-1, 1)
        n = predicted.shape[1]
        return np.asarray((3.0 * predicted[:, :, None] * np.eye(n)).reshape(-1, n))

    def _position_columns(self, along: FloatArray) -> FloatArray:
        """Return one column per point hit and direction: the effect of having hit beside it."""
        place = np.where(self.measured.hit < 0, self.measured.seen, self.measured.hit)
        points = np.unique(place)
        columns = [
            (self.measured.position_sigma * np.where((place == p)[:, None], slope, 0.0)).ravel()
            for p in points
            for slope in along
        ]
        return np.stack(columns, axis=1)

    def _sensor_columns(self, along: FloatArray) -> FloatArray:
        """Return one column per sensor and direction: the effect of having mounted it beside its point."""
        if (self.measured.hit < 0).all():
            return np.zeros((along[0].size, 0))
        columns = [
            (self.measured.position_sigma * np.where((self.measured.seen == p)[:, None], slope, 0.0)).ravel()
            for p in np.unique(self.measured.seen)
            for slope in along
        ]
        return np.stack(columns, axis=1)


@dataclass(frozen=True, eq=False)
class _Block:
    residual: FloatArray
    factors: FloatArray
    own: FloatArray
    variance: FloatArray
    mode: IntArray


def _projection(data: FloatArray, model: FloatArray, *, axis: int | None) -> FloatArray:
    """Return the factor on the model that fits the data best, per column or over all."""
    power = np.maximum(np.sum(model**2, axis=axis), 1e-300)
    return np.asarray(np.sum(data * model, axis=axis) / power)
