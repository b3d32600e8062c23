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
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import Obstacle
from updating.likelihood.base import NO_DOUBT, Doubt, Quantity, Setting, View
from updating.likelihood.baseline_prior import Before
from updating.likelihood.comparison import Block, Comparison, Layout, assemble
from updating.likelihood.constants import Constants, scatter_prior
from updating.likelihood.damping import Dampings
from updating.likelihood.fading_noise import FadingNoise
from updating.likelihood.frequency import Frequencies
from updating.likelihood.gaussian import gaussian
from updating.likelihood.level import Levels
from updating.likelihood.outliers import with_outliers
from updating.likelihood.phase import Phases
from updating.likelihood.places import Marks, Places
from updating.likelihood.trend import Trends
from updating.likelihood.unpaired import UnpairedModes
from updating.models.absorbers import swinging
from updating.models.state import NOMINAL, State
from updating.prediction.assignment import match, partners, undisturbed
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.problem.candidate import Candidate
from updating.problem.doubted import Doubted
from updating.problem.theory_error import TheoryError, left_out
from updating.test_data.measured import Measured
from updating.thresholds import (
    IMPORTED_MESH_DOUBT,
    STRAINED_LINEARISATION,
    UNSEEN_SHARES,
)
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
            Nuisances about which the prediction is linearised, see :meth:`compare`; left out, none [standard
            deviations].
        """
        stage = candidate.stage(self.predictor)
        parts = candidate.split(stage, coordinates.tolist())
        doubt = candidate.doubt_on(self.predictor, parts)
        found = self.compare(candidate.assemble(stage, parts), shift, doubt=doubt)
        return with_outliers(found, candidate.outliers)

    @cached_property
    def doubted(self) -> Doubted:
        """What all data doubt alike."""
        return Doubted(
            self.predictor, self.tolerances, self.measured.position_sigma, self.baseline is not None
        )

    @property
    def names(self) -> tuple[str, ...]:
        """What is doubted alike by all data: factors of the whole and of regions, masses and places of bodies."""
        return self.doubted.names

    @property
    def sigmas(self) -> FloatArray:
        """Their standard deviations [-, of places m]."""
        return self.doubted.sigmas

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
        return partners(self.measured, prediction, self.order, added)

    @property
    def wide(self) -> bool:
        """Whether tolerances are too wide for one linearisation, or bend what is measured beyond its noise.

        So may the places of points, three standard deviations from where they are stated. Never beside a baseline, see
        :meth:`compare`.
        """
        if self.baseline is not None:
            return False
        if 9.0 * self.place_bending.max(initial=0.0) > 1.0:
            return True
        if not len(self.sigmas):
            return False
        # half the square of 4 % is the error of a linearisation in ln f, as large as its usual noise
        return float(self.doubted.relative.max()) > 0.04 or float(self.bending.max()) > 1.0

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
            left = gaussian(replace(start, residual=np.nan_to_num(off)), (1.0,)).fit.chi2
            found.append(float(np.sqrt(left[0, 0, 0])))
        return np.array(found)

    def strain(self, shift: FloatArray) -> float:
        """Return the largest relative change that nuisances (n_names + n_places,) make of a property [-].

        What bends the data by its noise counts as that change of a property which a linearisation bears. Beside a
        baseline they make none.
        """
        if self.baseline is not None:
            return 0.0
        bent = np.sqrt(np.append(self.bending, self.place_bending)) * STRAINED_LINEARISATION
        relative = np.append(self.doubted.relative, np.zeros(len(self.place_bending)))
        moved = np.abs(shift) * np.maximum(relative, bent)
        return float(moved.max(initial=0.0)) if np.isfinite(moved).all() else np.inf

    @property
    def linearised(self) -> int:
        """About how many nuisances a prediction may be linearised: what all data doubt alike, and places of points."""
        return len(self.names) + len(self.place_bending)

    @cached_property
    def _places(self) -> Places | None:
        return next((one.places for one in self.quantities if isinstance(one, Constants)), None)

    @property
    def marks(self) -> tuple[Marks, ...]:
        """Where the hammer was to hit and sensors were to stand, at whose places a prediction may be linearised."""
        return () if self._places is None else self._places.marks

    @cached_property
    def place_bending(self) -> FloatArray:
        """How far constants leave their linearisation at one standard deviation of each place, (n_places,) [noise]."""
        if self._places is None or not self.marks:
            return np.zeros(0)
        start = self.compare(NOMINAL)
        noise = start.settled(1.0, UNSEEN_SHARES[-1]).variance[start.of("frf")]
        least = noise.reshape(-1, len(self.measured.frequency)).mean(axis=0)
        return self._places.bending(self.nominal, np.sqrt(least))

    def compare(
        self, state: State, shift: FloatArray | None = None, *, doubt: Doubt = NO_DOUBT
    ) -> Comparison:
        """Compare the test with a state of the model.

        Parameters
        ----------
        state : State
            Departure from the nominal model.
        shift : (n_names,) or (n_names + n_places,) array, optional
            Nuisances applied to the model before it is linearised, tolerances and then the places of points [standard
            deviations]. Beside a baseline none is: it corrects any specimen to the same modes, and one moved by them
            alone would count them twice.
        doubt : Doubt
            What the state leaves in doubt.
        """
        stated = np.zeros(0) if shift is None or self.baseline is not None else shift
        count = len(self.names)
        shift = stated[:count] if len(stated) else np.zeros(count)
        elsewhere, places = NOMINAL, np.zeros(0)
        if self._places is not None and stated[count:].any():
            elsewhere, places = self._places.elsewhere(stated[count:], self.predictor.base.plus(state))
        theory = self.predictor.base.plus(state).theory
        stage = self.predictor if theory is None else self.predictor.under(theory)
        whole = state.plus(self.doubted.departure(shift, stage)).plus(elsewhere)
        prediction = self.predictor.predict(whole, factors=self.names, at_least=self.reach)
        partners = self._partners(prediction, len(swinging(state.absorbers)))
        view = View(
            prediction.select(partners[0]),
            self.predictor.base.plus(whole),
            doubt,
            prediction,
            *partners[1:],
            places=places,
            exact=None if doubt.exact is NOMINAL else self._exactly(doubt.exact),
        )
        blocks = [quantity.block(view) for quantity in self.quantities]
        return assemble(
            blocks, self._layout(blocks), self.sigmas, shift, view.now, scatter_prior(self.measured)
        )

    def _exactly(self, state: State) -> Prediction:
        """Return the modes of a state in the order of the measured ones, without sensitivities."""
        found = self.predictor.predict(state, at_least=self.reach)
        return found.select(self._match(found))

    def _layout(self, blocks: Sequence[Block]) -> Layout:
        """Return where the data of each block stand: one layout for all states with as many nuisances of each kind."""
        key = tuple((block.named.shape[1], block.own.shape[1]) for block in blocks)
        if key not in self._layouts:
            self._layouts[key] = Layout.of(blocks, len(self.sigmas))
        return self._layouts[key]

    @cached_property
    def _layouts(self) -> dict[tuple[tuple[int, int], ...], Layout]:
        return {}

    @cached_property
    def quantities(self) -> tuple[Quantity, ...]:
        """The kinds of data that the test has, in the order of ``CHANNELS``."""
        setting = self.setting
        phases = Phases(setting)
        # what mesh and theory leave off in ln f, column by column and mode by mode; a baseline took it out
        known = None if self.baseline is not None else self.theory_error
        off, uneven = left_out(known, len(self.measured.frequency))
        further = self._accepted_variance() + uneven
        every = (
            Frequencies(setting, further, off, self._mesh_doubt),
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

    @property
    def _mesh_doubt(self) -> float:
        """How far an imported mesh of bricks leaves each ln f off, at the most; a baseline took it out [-]."""
        imported = self.predictor.spec.imported
        solid = imported is not None and imported.places.solid
        return IMPORTED_MESH_DOUBT if solid and self.baseline is None else 0.0

    def _accepted_variance(self) -> FloatArray:
        """Return how far the idealisations of the effects put into the model beforehand may be off, relative [-].

        What was there in the baseline, too, shifted both tests alike.
        """
        if not self.doubt_of_accepted:
            return np.zeros(len(self.measured.frequency))
        kept = (*self.before_additions, *self.predictor.additions[len(self.accepted) :])
        plain = self.predictor.for_test(self.measured, kept).predict(at_least=self.reach)
        hung = swinging(self.predictor.base.absorbers)
        before = undisturbed(self.nominal, plain, hung) if hung else plain.frequency[self._match(plain)]
        shift = np.log(self.nominal.frequency / before)
        return np.asarray((self.doubt_of_accepted * shift) ** 2)

    @property
    def doubt_of_accepted(self) -> float:
        """Largest fidelity of the effects put into the model beforehand [-]."""
        return max((effect.fidelity_on(self.predictor) for effect in self.accepted), default=0.0)
