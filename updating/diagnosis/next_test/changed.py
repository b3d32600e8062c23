"""The same test once more, with one thing changed: a mass, the hammer's level, the surroundings, more care."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import quantity
from updating.diagnosis.next_test.base import Maker, Outcome, Rival, Site, Trial
from updating.diagnosis.next_test.places import in_liquid, place_text, telling_places
from updating.diagnosis.next_test.repeat import Repeat
from updating.effects.base import Effect, total_mass
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.problem.specimen import SpecimenProblem


class AddedMass(Repeat):
    """The same test with a weighed mass at one place."""

    family = "added mass"
    cost = 4

    def __init__(self, site: Site, place: FloatArray, mass: float) -> None:
        """Take a place [m] and a mass [kg]."""
        compared = quantity(float(f"{mass:.2g}"), "kg")
        self.measure = f"repeat the test with a weighed mass of {compared} fixed at {place_text(site, place)}"
        self.place, self.mass = place, mass

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem with the mass in the model, before what a baseline has put there."""
        problem, place, mass = site.problem, self.place[None, :], self.mass

        def add(predictor: Predictor) -> State:
            return State(mass=(mass * predictor.reduced.unit_mass(place),))

        additions: list[Callable[[Predictor], State]] = list(problem.predictor.additions)
        additions.insert(len(additions) - (problem.baseline is not None), add)
        return replace(problem, predictor=problem.predictor.for_test(problem.measured, tuple(additions)))


class Again(Repeat):
    """The same test once more with care: a slip of the first does not come again."""

    family = "again"
    cost = 4
    measure = "check labels, signs and places of the points in question, and hit them again"

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem as it is."""
        return site.problem

    def keeps(self, effect: Effect) -> bool:
        """Leave out slips: effects that are about labelled points."""
        return not effect.labels


class InAir(Repeat):
    """The same specimen tested in air."""

    family = "in air"
    cost = 8
    measure = "test the same specimen in air, as a baseline"

    def problem(self, site: Site) -> SpecimenProblem:
        """Return the problem as it is."""
        return site.problem

    def keeps(self, effect: Effect) -> bool:
        """Leave out what the fluid does."""
        return "in air" not in effect.undone_by


class Levels(Trial):
    """Softer and harder hits: how frequencies follow the force."""

    family = "levels"
    cost = 4
    measure = "hit each point softly and hard, with forces of about 1 : 5"
    gain = 4.0
    """How many times better a dependence on the force is known once hits span such levels [-]."""

    def outcomes(self, site: Site, rivals: tuple[Rival, ...]) -> tuple[Outcome, ...]:
        """Return the slope that each rival expects."""
        return tuple(self._outcome(site, rival) for rival in rivals)

    def _outcome(self, site: Site, rival: Rival) -> Outcome:
        candidate, best = rival.explanation.candidate, rival.explanation.best.coordinates
        test = site.problem.measured
        assert test.slope_sigma is not None
        known = test.slope_sigma[np.isfinite(test.slope_sigma)]
        sigma = 1 / np.sqrt(np.sum(known**-2.0)) / self.gain

        def slope(coordinates: FloatArray) -> float:
            state = site.diagnosis_problem.place(candidate, coordinates)[site.index]
            expected = site.problem.predictor.predict(state, count=len(test.frequency)).slope
            return float(expected.mean() / sigma)

        here = slope(best)
        step = 1e-3 * np.eye(len(best)) * np.where(best < 0.5, 1.0, -1.0)
        by = [(slope(best + row) - here) / row.sum() for row in step]
        return Outcome(
            np.array([here]), np.zeros((1, len(rival.shift))), np.array([by]), np.zeros((1, 0)), np.ones(1)
        )


class SameTest(Maker):
    """The repetitions that a specimen admits."""

    share_of_mass = 0.05
    """Mass to add, relative to the structure's [-]: moves modes by some per cent, as an effect does, and bends nothing
    else. Doubled: twice the shift, and a model of the mass that begins to matter."""

    def trials(self, site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
        """Give them."""
        problem = site.problem
        mass = self.share_of_mass * total_mass(problem.predictor.spec)
        for place in telling_places(problem):
            yield AddedMass(site, place, mass)
        effects = [effect for rival in rivals for effect in rival.explanation.candidate.effects]
        if any(effect.labels for effect in effects):
            yield Again()
        wet = any("in air" in effect.undone_by for effect in effects)
        if (
            wet
            and in_liquid(problem) is not False
            and problem.baseline is None
            and not problem.predictor.additions
        ):
            yield InAir()
        if problem.measured.slope is not None:
            yield Levels()
