"""Readings of an instrument: a few numbers that an explanation predicts without a modal test."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.next_test.base import Outcome, Rival, Site, Trial
from updating.effects.base import Effect, Values
from updating.models.state import State
from updating.thresholds import DIFFERENCE_STEP

Parts = Sequence[tuple[Effect, Values]]


class InstrumentReading(Trial):
    """One or several readings, in units of their standard deviations."""

    @abstractmethod
    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return what the instrument shows, (n,) [standard deviations]."""

    @abstractmethod
    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return, per reading, its change per unit of the logarithm of each factor [standard deviations]."""

    def others(self, site: Site, rival: Rival) -> FloatArray:
        """Return the change of the readings per standard deviation of the doubts that are no tolerances, (n, m)."""
        count = len(site.doubts(rival)) - len(site.problem.names)
        return np.zeros((len(self.tolerances(site)), count))

    def outcomes(self, site: Site, rivals: tuple[Rival, ...]) -> tuple[Outcome, ...]:
        """Return what each rival expects."""
        return tuple(self._outcome(site, rival) for rival in rivals)

    def _outcome(self, site: Site, rival: Rival) -> Outcome:
        best = rival.explanation.best.coordinates
        value = self._at(site, rival, best)
        steps = [_moved(best, i) for i in range(len(best))]
        by = [(self._at(site, rival, there) - value) / change for there, change in steps]
        nuisance = np.zeros((len(value), len(rival.shift)))
        names = site.problem.names
        powers = np.array([[row.get(name, 0.0) for name in names] for row in self.tolerances(site)])
        columns = np.hstack(
            [powers.reshape(len(value), len(names)) * site.problem.sigmas, self.others(site, rival)]
        )
        nuisance[:, site.doubts(rival)] = columns
        return Outcome(
            value + nuisance @ rival.shift,
            nuisance,
            np.stack(by, axis=1) if by else np.zeros((len(value), 0)),
            np.zeros((len(value), 0)),
            np.ones(len(value)),
        )

    def _at(self, site: Site, rival: Rival, coordinates: FloatArray) -> FloatArray:
        candidate = rival.explanation.candidate
        parts = site.diagnosis_problem.parts(candidate, coordinates)[site.index]
        return self.read(site, parts, site.diagnosis_problem.place(candidate, coordinates)[site.index])


def _moved(coordinates: FloatArray, i: int) -> tuple[FloatArray, float]:
    change = DIFFERENCE_STEP if coordinates[i] < 0.5 else -DIFFERENCE_STEP
    there = coordinates.copy()
    there[i] += change
    return there, change
