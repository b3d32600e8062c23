"""The problem of a diagnosis: a test, a model, and everything that is doubted about either.

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
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.likelihood.comparison import KNOWN_SCATTER, UNKNOWN_SCATTER, Block, Comparison, assemble
from updating.models.base import FACTORS
from updating.models.state import State
from updating.prediction.matching import match
from updating.prediction.predict import Prediction, Predictor
from updating.problem.baseline_prior import Before
from updating.problem.candidate import Candidate, Doubt
from updating.problem.gates import TheoryError
from updating.test_data.measured import UNKNOWN_LEVEL, Measured
from updating.tolerances import Tolerances

SHAPE_FLOOR = 0.005
"""Error of a modal constant that no coherence shows (cross-talk, direction), relative to the mode's r.m.s."""

REPEATED_DAMPING = 0.1
"""Scatter of damping from one mounting of a specimen to the next, relative [-]."""

LEAST_NOISE = 1e-6
"""No frequency is known better than this, relative [-]."""

LATE = 0.01
"""Error of a modal constant, relative to the mode's r.m.s., per radian by which a delay turns it: no rational function
is a delay [1/rad]."""

HALF = 0.5
"""How much of what a plate's theory leaves out is expected, and in doubt [-]..."""

UNEVEN = 0.15
"""...and how much of it is in doubt mode by mode [-]."""

COMPLEX = 2.5
"""Imaginary part of a mode over its damping ratio times its size, where damping is not proportional [-]."""

MOST_TURNED = 30.0
"""No sensor is taken to sit nearer to a node than where a mode moves this much less than elsewhere [-]."""

FOLLOWS = 0.5
"""How much of a change of frequency (1 sigma of its logarithm) damping may follow otherwise than expected [-]."""

STEADY, LEAST_STEADY = 0.1, 3e-5
"""Drift of frequencies within a test: share of the scatter of re-mounting, and at least this [-]."""

AT_THE_END = 0.01
"""Points this near to an end, relative to the length, sit at it [-]."""

TURNED = 0.03
"""How far damping that is not proportional, and filters, turn a mode's constants (1 sigma) [rad]."""


NO_DOUBT = Doubt()


@dataclass(frozen=True, eq=False)
class SpecimenProblem:
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
    theory_error : Shortfall, optional
        How far the mesh, and a plate's theory, leave each mode's frequency off.
    mostly_alone : bool
        Whether most of the measured modes have no partner, and are left out.
    """

    predictor: Predictor
    measured: Measured
    tolerances: Tolerances
    order: IntArray
    baseline: Measured | None = None
    baseline_order: IntArray | None = None
    accepted: tuple[Effect, ...] = ()
    theory_error: TheoryError | None = None
    mostly_alone: bool = False

    @property
    def specimens(self) -> tuple[SpecimenProblem, ...]:
        """The specimens: this one."""
        return (self,)

    def applies(self, effect: Effect) -> str | None:
        """Return why an effect cannot be examined, or None."""
        return effect.why_not(self.predictor)

    def forms(self, effect: Effect) -> tuple[Variant, ...]:
        """Return the forms in which an effect may come."""
        stage = Candidate((effect,)).stage(self.predictor)
        return effect.variants(stage)

    def starts(self, candidate: Candidate) -> list[FloatArray]:
        """Return prior quantiles from which to search."""
        return candidate.starts(self.predictor)

    def parameters(self, candidate: Candidate) -> tuple[tuple[str, Parameter], ...]:
        """Return the parameters that are searched, as (effect.parameter, prior)."""
        return candidate.parameters(candidate.stage(self.predictor))

    def values(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, float]:
        """Return all values at prior quantiles, by effect.parameter."""
        return candidate.values(self.predictor, coordinates.tolist())

    def derived(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, tuple[float, str]]:
        """Return derived quantities at prior quantiles, by effect.name."""
        return candidate.derived(self.predictor, coordinates.tolist())

    def place(self, candidate: Candidate, coordinates: FloatArray) -> tuple[State, ...]:
        """Return the state of each specimen at prior quantiles."""
        return (candidate.state(self.predictor, coordinates.tolist()),)

    def parts(self, candidate: Candidate, coordinates: FloatArray) -> tuple[list[tuple[Effect, Values]], ...]:
        """Return the effects on each specimen with their values at prior quantiles."""
        return (candidate.split(candidate.stage(self.predictor), coordinates.tolist()),)

    def at(
        self, candidate: Candidate, coordinates: FloatArray, shift: FloatArray | None = None
    ) -> Comparison:
        """Compare the data with a candidate at prior quantiles.

        Parameters
        ----------
        candidate : Candidate
            Effects.
        coordinates : (k,) array
            Prior quantiles of their parameters [-].
        shift : (p,) array, optional
            Nuisances about which tolerances are linearised; left out, none [standard deviations].
        """
        (state,) = self.place(candidate, coordinates)
        stated = None if shift is None else shift[: len(self.names)]
        return self.compare(state, stated, doubt=candidate.doubt_on(self.predictor))

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
        stated = self.tolerances.damping
        return min(stated, REPEATED_DAMPING) if self.baseline is not None else stated

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
        return prediction.select(self._match(prediction))

    def _match(self, prediction: Prediction) -> IntArray:
        return match(self.measured, prediction, self.order)

    @property
    def wide(self) -> bool:
        """Whether tolerances are too wide for one linearisation."""
        return bool(len(self.sigmas)) and float(self.sigmas.max()) > 0.04

    def strain(self, shift: FloatArray) -> float:
        """Return the largest relative change that nuisances (p,) make of a property with a tolerance [-]."""
        moved = np.abs(shift[: len(self.names)] * self.sigmas)
        return float(moved.max(initial=0.0)) if np.isfinite(moved).all() else np.inf

    def compare(
        self, state: State, shift: FloatArray | None = None, *, doubt: Doubt = NO_DOUBT
    ) -> Comparison:
        """Compare the test with a state of the model.

        Parameters
        ----------
        state : State
            Departure from the nominal model.
        shift : (n_names,) array, optional
            Tolerance nuisances applied to the model before it is linearised [standard deviations].
        doubt : Doubt
            What the state leaves in doubt.
        """
        shift = np.zeros(len(self.names)) if shift is None else shift
        moved = State(factors=dict(zip(self.names, np.exp(shift * self.sigmas), strict=True)))
        whole = state.plus(moved)
        prediction = self.predictor.predict(whole, factors=self.names, at_least=self.reach)
        prediction = prediction.select(self._match(prediction))
        signs = np.ones(len(prediction.frequency))
        blocks = [self._frequencies(prediction, doubt.fidelity), self._dampings(prediction, doubt.damping)]
        if self.measured.phase is not None and self.measured.has_shapes:
            phases, signs = self._phases(self.predictor.base.plus(whole), prediction)
            blocks.append(phases)
        if self.measured.has_shapes:
            late = 2 * np.pi * self.measured.frequency * abs(self.predictor.base.plus(whole).delay)
            blocks.append(self._shapes(prediction, signs, doubt.fidelity, LATE * np.minimum(late, np.pi)))
        if self.measured.slope is not None:
            blocks.append(self._slopes(self.predictor.base.plus(whole), prediction, doubt.fidelity))
        prior = KNOWN_SCATTER if self.measured.repeated else UNKNOWN_SCATTER
        return assemble(sorted(blocks, key=lambda b: b.channel), self.sigmas, shift, prediction, prior)

    def _frequencies(self, now: Prediction, fidelity: float) -> Block:
        test = self.measured
        variance = (test.frequency_sigma / test.frequency) ** 2 + max(test.repeatability, LEAST_NOISE) ** 2
        by = now.log_frequency_by
        if self.before is not None:
            doubt, known = self.before.frequency(now)
            variance, by = variance + doubt, by - known
        variance = variance + self._accepted_variance
        n = len(test.frequency)
        named = np.zeros((n, 0))
        expected, own, uneven = self._unmodelled
        variance = variance + uneven
        if fidelity:
            # an idealisation errs in the size of the whole shift, and again in each mode
            doubtful = fidelity * np.log(now.frequency / self.nominal.frequency)
            variance, named = variance + doubtful**2, doubtful[:, None]
        residual = np.log(test.frequency / now.frequency) - expected
        return Block(0, residual, variance, by, named, own, np.arange(n))

    @cached_property
    def _unmodelled(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return what mesh and theory leave off in ln f: its expectation, columns of doubt, variance mode by mode.

        A baseline has taken it out. A beam's theory is an effect of its own; a plate's is no effect, and since the
        estimate may be half of itself off and a test may come from a thin plate, half of it is expected.
        """
        found, n = self.theory_error, len(self.measured.frequency)
        if found is None or not found.known or self.baseline is not None:
            return np.zeros(n), np.zeros((n, 0)), np.zeros(n)
        theory = found.theory if self.predictor.spec.kind == "plate" else np.zeros(n)
        columns = np.stack([found.mesh, HALF * theory], axis=1)
        return HALF * theory, columns, (UNEVEN * theory) ** 2 + (HALF * found.mesh) ** 2

    @cached_property
    def _accepted_variance(self) -> FloatArray:
        """How far the idealisations of the effects put into the model beforehand may be off, relative [-]."""
        if not self.doubt_of_accepted:
            return np.zeros(len(self.measured.frequency))
        without = self.predictor.for_test(self.measured, self.predictor.additions[len(self.accepted) :])
        plain = without.predict(at_least=self.reach)
        plain = plain.select(self._match(plain))
        shift = np.log(self.nominal.frequency / plain.frequency)
        return np.asarray((self.doubt_of_accepted * shift) ** 2)

    @property
    def doubt_of_accepted(self) -> float:
        """Largest fidelity of the effects put into the model beforehand [-]."""
        return max((effect.fidelity_on(self.predictor) for effect in self.accepted), default=0.0)

    def _damping_tolerance(self, now: Prediction) -> FloatArray:
        """Return the doubt in the expected damping of each mode: small where a baseline measured it [-]."""
        stated = self.tolerances.damping
        if self.before is None:
            return np.full(len(now.frequency), stated)
        return np.where(self.before.seen(now) > 0.5, self.damping_doubt, stated)

    def _dampings(self, now: Prediction, doubt: float) -> Block:
        rows = self.damping_known
        test = self.measured
        relative = np.nan_to_num(test.damping_sigma[rows] / test.damping[rows], nan=0.05)
        expected = np.maximum(now.damping[rows], 1e-7)
        tolerance = self._damping_tolerance(now)[rows]
        # ratios go up or down with frequency as the mechanism has it: viscous ones fall, those of stiffness rise
        moved = FOLLOWS * np.log(now.frequency[rows] / self.nominal.frequency[rows])
        variance = relative**2 + tolerance**2 + doubt**2 + moved**2
        level = np.stack([tolerance, np.full(len(rows), doubt)], axis=1)[:, : 1 + (doubt > 0)]
        return Block(
            1,
            np.log(test.damping[rows] / expected),
            variance,
            np.zeros((len(rows), len(self.names))),
            level if len(rows) else np.zeros((0, 0)),
            np.zeros((len(rows), 0)),
            rows,
        )

    def _phases(self, whole: State, now: Prediction) -> tuple[Block, FloatArray]:
        """Return how far each chain turns each mode beyond the delay, and the factor a delay makes on constants."""
        test = self.measured
        assert test.phase is not None
        assert test.phase_sigma is not None
        expected = -2 * np.pi * test.frequency * whole.delay
        turns = np.round((expected - test.phase) / np.pi)
        residual = test.phase - expected + np.pi * turns
        n_chains, n_modes = residual.shape
        columns = np.repeat(TURNED * np.eye(n_modes)[None], n_chains, axis=0).reshape(-1, n_modes)
        spread = test.phase_sigma**2 + (0.3 * TURNED) ** 2 + self._complexity**2
        block = Block(
            3,
            residual.ravel(),
            spread.ravel(),
            np.zeros((residual.size, len(self.names))),
            np.zeros((residual.size, 0)),
            columns,
            np.tile(np.arange(n_modes), n_chains),
        )
        assert test.channel_group is not None
        # the residue of exp(-s tau) H(s) holds exp(-s tau) at the pole, whose decay makes it larger
        grown = np.exp(2 * np.pi * test.frequency * np.nan_to_num(test.damping) * whole.delay)
        return block, np.where(turns[test.channel_group] % 2 == 0, grown, -grown)

    @cached_property
    def _complexity(self) -> FloatArray:
        """Return how far damping may turn the constants that a chain sees, (n_chains, n_modes) [rad].

        Whether damping is viscous or structural turns them by the damping ratio; where it is not proportional, a
        mode takes on imaginary parts of about the damping ratio times its size, which weigh most where the sensor
        sits near a node of it.
        """
        test = self.measured
        assert test.channel_group is not None
        member = (test.channel_group == np.arange(int(test.channel_group.max()) + 1)[:, None]).astype(float)
        ratio = np.where(np.isfinite(test.damping), test.damping, 0.0)
        prediction = self.nominal
        rows = self.predictor.nominal_rows["w"][:, : len(prediction.vectors)] @ prediction.vectors
        seen = np.stack(
            [np.abs(rows[test.seen[test.channel_group == c]]).mean(axis=0) for c in range(len(member))]
        )
        typical = np.sqrt(np.mean(rows**2, axis=0))
        away = typical / np.maximum(seen, typical / MOST_TURNED)
        return np.asarray(ratio * np.hypot(1.0, COMPLEX * away))

    def _slopes(self, whole: State, now: Prediction, fidelity: float) -> Block:
        """Return by how much more than predicted frequencies depend on the force, times its mean."""
        test = self.measured
        assert test.slope is not None
        assert test.slope_sigma is not None
        level = test.level or 1.0
        n = len(test.slope)
        uneven = fidelity * whole.slope * level
        known = np.isfinite(test.slope)
        return Block(
            4,
            level * np.where(known, test.slope - whole.slope, 0.0),
            np.where(known, (level * test.slope_sigma) ** 2 + uneven**2 + self._steady**2, 1.0),
            np.zeros((n, len(self.names))),
            np.zeros((n, 0)),
            np.zeros((n, 0)),
            np.arange(n),
        )

    @property
    def _steady(self) -> float:
        """Change of frequency over the levels of a test that needs no joint: it is not kept at one temperature [-]."""
        return max(STEADY * self.measured.repeatability, LEAST_STEADY)

    def _shapes(self, now: Prediction, signs: FloatArray, fidelity: float, late: FloatArray) -> Block:
        test, scale = self.measured, self.scale
        constants, by, doubt = now.constants, now.constants_by, np.zeros_like(now.constants)
        if self.before is not None:
            missed, doubt, known = self.before.shapes(now)
            constants, by = constants + missed, by - known
        if signs.ndim == 1:
            signs = np.broadcast_to(signs, constants.shape)
        level = signs * test.same_signs(constants) / scale
        if not test.absolute:
            level = level * _projection(test.constants / scale, constants * level, axis=0)
        elif test.calibration > UNKNOWN_LEVEL:
            level = level * float(_projection(test.constants / scale, constants * level, axis=None))
        predicted, by = constants * level, by * level[:, :, None]
        variance = (test.constants_sigma / scale) ** 2 + doubt * level**2 + SHAPE_FLOOR**2 + late**2
        louder = np.zeros((predicted.size, 0))
        if fidelity:
            # a change of the modes' levels errs as a whole, what is no mere change of level point by point
            before = self.nominal.constants * test.same_signs(self.nominal.constants) / scale
            share = _projection(predicted, before, axis=0)
            variance = variance + (fidelity * (predicted - share * before)) ** 2
            louder = (fidelity * (share - 1) * before).reshape(-1, 1)
        gain = self._level_columns(predicted)
        sensors = self._sensor_columns(now.along_seen * level)
        along = self._registration_column(now.along * level, now.along_seen * level)
        own = [self._position_columns(now.along * level), sensors, along, louder]
        modes = np.broadcast_to(np.arange(predicted.shape[1]), predicted.shape).ravel()
        if not test.absolute:
            own, gain = [gain, *own], np.zeros((predicted.size, 0))
        return Block(
            2,
            (test.constants / scale - predicted).ravel(),
            variance.ravel(),
            by.reshape(predicted.size, len(self.names)),
            gain,
            np.hstack(own),
            modes,
        )

    def _level_columns(self, predicted: FloatArray) -> FloatArray:
        """Return the gain of the whole test, or of each mode where only shapes are known."""
        if self.measured.absolute:
            return (self.measured.level_sigma * predicted).reshape(-1, 1)
        n = predicted.shape[1]
        return np.asarray((3.0 * predicted[:, :, None] * np.eye(n)).reshape(-1, n))

    def _position_columns(self, along: FloatArray) -> FloatArray:
        """Return one column per point hit and direction: the effect of having hit beside it."""
        return self._columns_by_point(
            np.where(self.measured.hit < 0, self.measured.seen, self.measured.hit), along
        )

    def _columns_by_point(self, place: IntArray, along: FloatArray) -> FloatArray:
        """Return one column per point and direction of slopes (dim, n_frf, n_modes), each times the doubt there."""
        points, rank = np.unique(place, return_inverse=True)
        n_dim, n_frf, n_modes = along.shape
        columns = np.zeros((n_frf, n_modes, len(points), n_dim))
        for axis, slope in enumerate(along):
            sigma = np.array([self._place_sigma(int(p), axis) for p in points])
            columns[np.arange(n_frf), :, rank, axis] = sigma[rank, None] * slope
        return columns.reshape(n_frf * n_modes, -1)

    @cached_property
    def _loose_length(self) -> float:
        """Doubt in where points lie along x, 0 where one end is clamped and they keep their distance from the other.

        Else nobody says from which end they were measured: half of the doubt in the length. A baseline has the same.
        """
        one_end = len({edge for edge in self.predictor.spec.clamped if edge[0] == "x"}) == 1
        if one_end or self.before is not None or self.predictor.spec.kind == "matrices":
            return 0.0
        return 0.5 * self.tolerances.factors.get("length", 0.0) * self.predictor.spec.length

    def _place_sigma(self, point: int, axis: int) -> float:
        """Return the doubt in a point's place; one at the end of the model was at the end of the specimen [m]."""
        sigma, length = self.measured.position_sigma, self.predictor.spec.length
        x = float(self.measured.points[point, 0])
        at_end = axis == 0 and min(x, length - x) < AT_THE_END * length
        return float(np.hypot(sigma, 2 * self._loose_length)) if at_end else sigma

    def _registration_column(self, hit: FloatArray, seen: FloatArray) -> FloatArray:
        """Return a column for where the points as a whole lie along x."""
        if not self._loose_length:
            return np.zeros((hit[0].size, 0))
        bare = (self.measured.hit < 0)[:, None]
        return np.asarray(self._loose_length * (np.where(bare, 0.0, hit[0]) + seen[0])).reshape(-1, 1)

    def _sensor_columns(self, along: FloatArray) -> FloatArray:
        """Return one column per sensor and direction: the effect of having mounted it beside its point."""
        if (self.measured.hit < 0).all():
            return np.zeros((along[0].size, 0))
        return self._columns_by_point(self.measured.seen, along)


def _projection(data: FloatArray, model: FloatArray, *, axis: int | None) -> FloatArray:
    """Return the factor on the model that fits the data best, per column or over all."""
    power = np.maximum(np.sum(model**2, axis=axis), 1e-300)
    return np.asarray(np.sum(data * model, axis=axis) / power)
