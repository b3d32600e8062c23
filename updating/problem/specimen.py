"""The problem of a diagnosis: a test, a model, and everything that is doubted about either.

Every doubt that is not an effect is a *nuisance*: a column of sensitivities with a standard normal prior.
They are the modeller's tolerances, the calibration, the common level of damping, and where each point was
really hit. What is left is independent noise: the identification's covariance, re-mounting scatter, the
scatter of damping from mode to mode, and how far an effect's own idealisation may be off. Each kind of data has its
own: see :mod:`updating.likelihood`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from identification.pairing import counterparts
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import Obstacle
from updating.likelihood.base import NO_DOUBT, Doubt, Quantity, Setting, View
from updating.likelihood.baseline_prior import Before
from updating.likelihood.comparison import Comparison, assemble
from updating.likelihood.constants import Constants, scatter_prior
from updating.likelihood.damping import Dampings
from updating.likelihood.fading_noise import FadingNoise
from updating.likelihood.frequency import Frequencies
from updating.likelihood.gaussian import gaussian
from updating.likelihood.level import Levels
from updating.likelihood.outliers import with_outliers
from updating.likelihood.phase import Phases
from updating.likelihood.trend import Trends
from updating.likelihood.unpaired import UnpairedModes
from updating.models.absorbers import Absorber, swinging
from updating.models.base import FACTORS
from updating.models.named_factors import departure, regions_of, unassigned
from updating.models.state import NOMINAL, State
from updating.prediction.assignment import match_with_unpaired, offers
from updating.prediction.matching import match
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.problem.candidate import Candidate
from updating.problem.theory_error import TheoryError
from updating.test_data.measured import Measured
from updating.thresholds import SHAPE_NOISE_SCALES, STATED_MASS_DOUBT, STRAINED_LINEARISATION
from updating.tolerances import Tolerances


@dataclass(frozen=True, eq=False, kw_only=True)
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
    theory_error : TheoryError, optional
        How far the mesh, and the theory, leave each mode's frequency off.
    mostly_alone : bool
        Whether most of the measured modes have no partner, and are left out.
    before_additions : tuple of callables
        What puts those of the accepted effects into a model that were there in the baseline, too.
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
    before_additions: tuple[Callable[[Predictor], State], ...] = ()

    @property
    def specimens(self) -> tuple[SpecimenProblem, ...]:
        """The specimens: this one."""
        return (self,)

    def applies(self, effect: Effect) -> Obstacle | None:
        """Return why an effect cannot be examined, or None."""
        return effect.why_not(self.predictor) or effect.unseen(self.predictor)

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
        found = self.compare(state, stated, doubt=candidate.doubt_on(self.predictor))
        return with_outliers(found, candidate.outliers)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """What is doubted alike by all data: factors of the whole and of regions, masses and places of bodies."""
        known = {name for term in self.predictor.reduced.structure.terms for name in term.powers}
        whole = [n for n in FACTORS if n in known and self.tolerances.factors.get(n, 0.0) > 0]
        own = dict.fromkeys(
            [*self.tolerances.parts, *self.tolerances.bounds, *unassigned(self.predictor.spec)]
        )
        regional = [n for n in own if self._sigma(n) > 0 and self._of_regions(n, known)]
        return (*whole, *regional, *self.predictor.body_changes)

    def _of_regions(self, name: str, known: set[str]) -> bool:
        """Return whether a name is a factor of regions of the model."""
        regions, factor = regions_of(self.predictor.spec, name)
        return bool(regions) and factor in known

    @property
    def reach(self) -> int:
        """How many of the model's modes a match may need."""
        return int(self.order.max()) + 3

    @cached_property
    def before(self) -> Before | None:
        """What the baseline has already determined."""
        if self.baseline is None or self.baseline_order is None:
            return None
        return Before(
            self.predictor,
            self.measured,
            self.baseline,
            self.baseline_order,
            self.names,
            self.before_additions,
        )

    @cached_property
    def sigmas(self) -> FloatArray:
        """Their standard deviations [-, of places m]."""
        return np.array([self._sigma(name) for name in self.names])

    def _sigma(self, name: str) -> float:
        if (change := self.predictor.body_changes.get(name)) is not None:
            return self.measured.position_sigma if change.of_place else STATED_MASS_DOUBT
        return self.tolerances.factor(name)

    @cached_property
    def _relative_sigmas(self) -> FloatArray:
        """The standard deviations, those of places relative to the size of the model [-]."""
        places = {name for name, change in self.predictor.body_changes.items() if change.of_place}
        size = [self.predictor.spec.length if name in places else 1.0 for name in self.names]
        return np.asarray(self.sigmas / size)

    def departure(self, shift: FloatArray, stage: Predictor) -> State:
        """Return the departure that nuisances make in what all data doubt alike.

        Parameters
        ----------
        shift : (n_names,) array
            Nuisances [standard deviations].
        stage : Predictor
            What it is put on: this specimen's, under one theory or another, each with a basis of its own.
        """
        moved = dict(zip(self.names, (shift * self.sigmas).tolist(), strict=True))
        bodies = stage.body_changes
        factors = {name: float(np.exp(by)) for name, by in moved.items() if name not in bodies}
        masses = tuple(by * bodies[name].mass for name, by in moved.items() if name in bodies and by)
        return departure(self.predictor.spec, factors).plus(State(mass=masses))

    @property
    def nominal(self) -> Prediction:
        """The nominal prediction of the matched modes."""
        return self._nominal[0]

    @cached_property
    def _nominal(self) -> tuple[Prediction, Prediction]:
        """The nominal prediction of the matched modes, and of those that the test has not."""
        prediction = self.predictor.predict(factors=self.names, at_least=self.reach)
        order = self._match(prediction)
        return prediction.select(order), prediction.select(
            np.setdiff1d(np.arange(len(prediction.frequency)), order)
        )

    def _match(self, prediction: Prediction) -> IntArray:
        return match(self.measured, prediction, self.order)

    def _partners(self, prediction: Prediction, added: int) -> tuple[IntArray, IntArray, IntArray]:
        """Return the predicted mode of each measured one, of unpaired ones where a state adds modes, and may be."""
        unpaired = self.measured.unpaired
        if unpaired is None:
            nothing = np.zeros(0, dtype=np.int64)
            return self._match(prediction), nothing, nothing
        if added:
            order, claims = match_with_unpaired(self.measured, unpaired, prediction, self.order, added)
        else:
            order, claims = self._match(prediction), np.full(len(unpaired.frequency), -1)
        return order, claims, offers(unpaired, prediction, np.append(order, claims[claims >= 0]))

    @property
    def wide(self) -> bool:
        """Whether tolerances are too wide for one linearisation, or bend what is measured beyond its noise.

        Never beside a baseline, see :meth:`compare`.
        """
        if not len(self.sigmas) or self.baseline is not None:
            return False
        # half the square of 4 % is the error of a linearisation in ln f, as large as its usual noise
        return float(self._relative_sigmas.max()) > 0.04 or float(self.bending.max()) > 1.0

    @cached_property
    def bending(self) -> FloatArray:
        """How far all data leave their linearisation at one standard deviation of each factor, (n_names,) [noise].

        What nuisances take up counts for nothing.

        Most follow a power of it and stay. Not so the shapes of modes that are close, which turn into each other,
        nor the constants of a mode that hardly moves where it is hit, which are products of two that change.
        """
        count = len(self.names)
        start = self.compare(NOMINAL)
        found = []
        for shift in np.eye(count):
            there = self.compare(NOMINAL, shift)
            # a comparison's residual is carried back to no shift: by its own slope there, by the first one here
            off = there.residual - start.residual - (there.nuisance - start.nuisance)[:, :count] @ shift
            left = gaussian(replace(start, residual=np.nan_to_num(off)), SHAPE_NOISE_SCALES[:1]).chi2
            found.append(float(np.sqrt(left[0, 0])))
        return np.array(found)

    def strain(self, shift: FloatArray) -> float:
        """Return the largest relative change that tolerances (n_names,) make of a property [-].

        What bends the data counts as that change of a property which a linearisation bears as well. Beside a baseline
        they make none.
        """
        if self.baseline is not None:
            return 0.0
        bent = np.sqrt(self.bending) * STRAINED_LINEARISATION
        moved = np.abs(shift) * np.maximum(self._relative_sigmas, bent)
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
            Tolerance nuisances applied to the model before it is linearised [standard deviations]. Beside a baseline
            none is: it corrects any specimen to the same modes, and one moved by them alone would count them twice.
        doubt : Doubt
            What the state leaves in doubt.
        """
        shift = np.zeros(len(self.names)) if shift is None or self.baseline is not None else shift
        theory = self.predictor.base.plus(state).theory
        stage = self.predictor if theory is None else self.predictor.under(theory)
        whole = state.plus(self.departure(shift, stage))
        prediction = self.predictor.predict(whole, factors=self.names, at_least=self.reach)
        partners = self._partners(prediction, len(swinging(state.absorbers)))
        view = View(
            prediction.select(partners[0]), self.predictor.base.plus(whole), doubt, prediction, *partners[1:]
        )
        blocks = [quantity.block(view) for quantity in self.quantities]
        return assemble(blocks, self.sigmas, shift, view.now, scatter_prior(self.measured))

    @cached_property
    def quantities(self) -> tuple[Quantity, ...]:
        """The kinds of data that the test has, in the order of ``CHANNELS``."""
        setting = self.setting
        phases = Phases(setting)
        left_out, uneven = self._left_out()
        further = self._accepted_variance() + uneven
        every = (
            Frequencies(setting, further, left_out),
            Dampings(setting),
            Constants(setting, phases, further),
            phases,
            Levels(setting),
            Trends(setting),
            UnpairedModes(setting),
            FadingNoise(setting),
        )
        return tuple(quantity for quantity in every if quantity.present)

    @cached_property
    def setting(self) -> Setting:
        """Test and model, as every kind of data needs the two."""
        return Setting(
            self.predictor,
            self.measured,
            self.tolerances,
            self.names,
            self.sigmas,
            *self._nominal,
            self.before,
        )

    @property
    def damping_known(self) -> IntArray:
        """Rows of modes whose damping is measured and expected."""
        return Dampings(self.setting).rows

    def _left_out(self) -> tuple[FloatArray, FloatArray]:
        """Return what mesh and theory leave off in ln f: columns common to all modes, variance mode by mode.

        Nothing where nothing is known of it, or a baseline took it out. Half of the mesh's own error is in doubt mode
        by mode, beside all of it in common (judged).
        """
        found = self.theory_error
        if found is None or not found.known or self.baseline is not None:
            n = len(self.measured.frequency)
            return np.zeros((n, 0)), np.zeros(n)
        columns = [found.mesh, *(column for column in (found.width, found.shear) if column.any())]
        return np.stack(columns, axis=1), (0.5 * found.mesh) ** 2

    def _accepted_variance(self) -> FloatArray:
        """Return how far the idealisations of the effects put into the model beforehand may be off, relative [-].

        What was there in the baseline, too, shifted both tests alike.
        """
        if not self.doubt_of_accepted:
            return np.zeros(len(self.measured.frequency))
        kept = self.before_additions, self.predictor.additions[len(self.accepted) :]
        without = self.predictor.for_test(self.measured, (*kept[0], *kept[1]))
        plain = without.predict(at_least=self.reach)
        hung = swinging(self.predictor.base.absorbers)
        before = _undisturbed(self.nominal, plain, hung) if hung else plain.frequency[self._match(plain)]
        shift = np.log(self.nominal.frequency / before)
        return np.asarray((self.doubt_of_accepted * shift) ** 2)

    @property
    def doubt_of_accepted(self) -> float:
        """Largest fidelity of the effects put into the model beforehand [-]."""
        return max((effect.fidelity_on(self.predictor) for effect in self.accepted), default=0.0)


def _undisturbed(now: Prediction, plain: Prediction, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return from where absorbers moved each mode: the structure's most like it, or one of theirs, (n_modes,) [Hz].

    Paired by modal overlap; what finds no mode of the structure is the mode of the absorber that swings nearest.
    """
    alike = now.overlap(plain)
    # what no mode of the structure has of it is the absorbers'
    theirs = np.repeat(1 - alike.sum(axis=1, keepdims=True), len(absorbers), axis=1)
    columns = counterparts(-np.hstack([alike, theirs]))
    alone = np.array([np.sqrt(one.stiffness / one.mass) / (2 * np.pi) for one in absorbers])
    nearest = alone[np.argmin(np.abs(np.log(now.frequency[:, None] / alone)), axis=1)]
    known = np.append(plain.frequency, np.full(len(absorbers), np.nan))[columns]
    return np.asarray(np.where(np.isnan(known), nearest, known))
