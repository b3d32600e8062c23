"""Another modal test of the specimen: the same once more, or with something changed."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from identification.pairing import counterparts
from updating.diagnosis.next_test.base import Outcome, Rival, Site, Trial
from updating.effects.base import Effect
from updating.likelihood.base import Doubt
from updating.likelihood.comparison import Comparison
from updating.models.absorbers import swinging
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.problem.specimen import SpecimenProblem
from updating.test_data.measured import Measured
from updating.thresholds import DIFFERENCE_STEP


class Repeat(Trial):
    """A modal test whose outcome every explanation predicts.

    Its modes are those of the test so far, as well known as these; what is expected is compared with what the first
    rival expects.
    """

    same_chain = True
    """Whether calibration, and what else is in doubt about the test so far, is the same in this one."""

    unknown_shape_noise = 0.01
    """Noise of a modal constant where nothing is known of it, relative to its mode's r.m.s. [-]: of a careful test."""

    @abstractmethod
    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem of such a test, whose data are still those of the test so far."""

    def keeps(self, effect: Effect) -> bool:
        """Return whether an effect is there in this test, too."""
        return True

    def outcomes(self, site: Site, rivals: tuple[Rival, ...]) -> tuple[Outcome, ...]:
        """Return what each rival expects."""
        blank = self.problem(site)
        lead, _ = self._there(blank, site, rivals[0], rivals[0].explanation.best.coordinates)
        data = imagined(blank.measured, blank.predictor, lead, blank.order)
        then = replace(blank, measured=data, predictor=predictor_for(blank.predictor, data))
        return tuple(self._outcome(then, site, rival) for rival in rivals)

    def _there(
        self, then: SpecimenProblem, site: Site, rival: Rival, coordinates: FloatArray
    ) -> tuple[State, Doubt]:
        """Return the state in that test, and what it leaves in doubt."""
        candidate, predictor = rival.explanation.candidate, then.predictor
        every = site.diagnosis_problem.parts(candidate, coordinates)[site.index]
        parts = [part for part in every if self.keeps(part[0])]
        return candidate.assemble(candidate.stage(predictor), parts), candidate.doubt_on(predictor, parts)

    def _compare(
        self, then: SpecimenProblem, site: Site, rival: Rival, coordinates: FloatArray
    ) -> Comparison:
        state, doubt = self._there(then, site, rival, coordinates)
        return then.compare(state, doubt=doubt)

    def _outcome(self, then: SpecimenProblem, site: Site, rival: Rival) -> Outcome:
        best = rival.explanation.best
        here = self._compare(then, site, rival, best.coordinates)
        by = []
        for i in range(len(best.coordinates)):
            there = best.coordinates.copy()
            change = DIFFERENCE_STEP if there[i] < 0.5 else -DIFFERENCE_STEP
            there[i] += change
            moved = self._compare(then, site, rival, there)
            by.append((here.residual - moved.residual) / change)
        old = site.doubts(rival)
        whole = self.same_chain and len(here.doubts) == len(old)
        common = len(old) if whole else len(then.names)
        nuisance = np.zeros((len(here.residual), len(rival.shift)))
        nuisance[:, old[:common]] = here.nuisance[:, here.doubts[:common]]
        return Outcome(
            here.residual - nuisance @ rival.shift,
            nuisance,
            np.stack(by, axis=1) if by else np.zeros((len(here.residual), 0)),
            np.delete(here.nuisance, here.doubts[:common], axis=1),
            here.noise(best.marginal.scale),
        )


def predictor_for(predictor: Predictor, measured: Measured) -> Predictor:
    """Return the predictor of other data on the same reduced basis."""
    return predictor.for_test(measured)


def imagined(measured: Measured, predictor: Predictor, state: State, order: IntArray) -> Measured:
    """Return the data that a state would give, as well known as those of the test.

    Parameters
    ----------
    measured : Measured
        Points, FRFs and how well they are known.
    predictor : Predictor
        The model, observed from these points.
    state : State
        Departure from it.
    order : (n_modes,) int array
        Ranks of the modes.
    """
    prediction = predictor.predict(state, at_least=int(order.max()) + 3 + len(swinging(state.absorbers)))
    ranks = np.argsort(prediction.frequency)[np.sort(order)]
    if swinging(state.absorbers):
        ranks = _of_structure(predictor, prediction, np.sort(order))
    modes = prediction.select(ranks)
    known = np.median(measured.frequency_sigma / measured.frequency)
    size = np.sqrt(np.mean(modes.constants**2, axis=0)) if len(measured.seen) else np.ones(len(ranks))
    return replace(
        measured,
        frequency=modes.frequency,
        frequency_sigma=known * modes.frequency,
        damping=modes.damping,
        damping_sigma=_relative(measured.damping_sigma, measured.damping) * modes.damping,
        constants=modes.constants,
        constants_sigma=_shape_noise(measured) * size * np.ones_like(modes.constants),
        phase=None,
        phase_sigma=None,
        trusted=None,
        slope=None,
        slope_sigma=None,
        trend=None,
        trend_sigma=None,
        noise=None,
        shared=None,
        hit_errors=None,
        quadrature=None,
        unpaired=None,
    )


def _of_structure(predictor: Predictor, prediction: Prediction, order: IntArray) -> IntArray:
    """Return which modes of a state that adds some are those of the structure without, by rank."""
    before = predictor.predict(at_least=int(order.max()) + 1).select(order)
    return counterparts(-before.overlap(prediction))


def _relative(sigma: FloatArray, value: FloatArray) -> float:
    stated = sigma / value
    stated = stated[np.isfinite(stated)]
    return float(np.median(stated)) if len(stated) else 0.05


def _shape_noise(measured: Measured) -> float:
    if not measured.constants.size:
        return Repeat.unknown_shape_noise
    size = np.sqrt(np.mean(measured.constants**2, axis=0))
    return float(np.median(measured.constants_sigma / np.maximum(size, 1e-300)))
