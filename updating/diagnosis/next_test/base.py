"""What every hypothetical test defines: what it costs, and what each explanation predicts of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.comparison import Comparison
from updating.problem.specimen import SpecimenProblem

UNIFORM = 12.0
"""Inverse variance of a parameter about which nothing is known but its prior quantile's range [-]."""


@dataclass(frozen=True, eq=False)
class Rival:
    """An explanation as the data so far leave it: its best parameters and how far all doubts may still move.

    Parameters
    ----------
    diagnosis_problem : Problem or Several
        Test and model.
    explanation : Explanation
        What was compared.
    """

    diagnosis_problem: DiagnosisProblem
    explanation: Explanation

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its effects."""
        return self.explanation.names

    @property
    def shift(self) -> FloatArray:
        """Most probable nuisances [standard deviations]."""
        return self.explanation.best.marginal.shift

    @cached_property
    def spread(self) -> FloatArray:
        """Covariance of nuisances and prior quantiles given all data so far, linearised at the best."""
        best = self.explanation.best
        own = sensitivities(self.diagnosis_problem, self.explanation.candidate, best)
        columns = np.hstack([best.comparison.nuisance, own])
        count = best.comparison.nuisance.shape[1]
        prior = np.concatenate([np.ones(count), np.full(own.shape[1], UNIFORM)])
        noise = best.comparison.noise(best.marginal.scale)
        return np.asarray(np.linalg.inv(np.diag(prior) + (columns.T / noise) @ columns))


@dataclass(frozen=True, eq=False)
class Site:
    """One specimen on which a test may be made.

    Parameters
    ----------
    diagnosis_problem : Problem or Several
        All specimens.
    index : int
        Which of them.
    title : str
        How the specimen is called, empty where there is only one.
    """

    diagnosis_problem: DiagnosisProblem
    index: int
    title: str = ""

    @property
    def problem(self) -> SpecimenProblem:
        """The problem of this specimen."""
        return self.diagnosis_problem.specimens[self.index]

    def comparison(self, rival: Rival) -> Comparison:
        """Return this specimen's part of what a rival was compared by."""
        explanation = rival.explanation
        if len(self.diagnosis_problem.specimens) == 1:
            return explanation.best.comparison
        candidate, predictor = explanation.candidate, self.problem.predictor
        parts = self.diagnosis_problem.parts(candidate, explanation.best.coordinates)[self.index]
        state = candidate.assemble(candidate.stage(predictor), parts)
        return self.problem.compare(state, doubt=candidate.doubt_on(predictor, parts))

    def doubts(self, rival: Rival) -> IntArray:
        """Return which of a rival's nuisances are this specimen's named doubts."""
        start = 0
        for i in range(self.index):
            start += Site(self.diagnosis_problem, i).comparison(rival).nuisance.shape[1]
        return start + self.comparison(rival).doubts


@dataclass(frozen=True, eq=False)
class Outcome:
    """What one explanation expects of a test; only differences between explanations mean something.

    Parameters
    ----------
    value : (n,) array
        Expected readings.
    nuisance : (n, p) array
        Their change per standard deviation of the nuisances of the data so far.
    by : (n, k) array
        Their change per prior quantile of its parameters.
    own : (n, q) array
        Their change per standard deviation of what is in doubt about this test alone.
    variance : (n,) array
        Variance of the noise.
    """

    value: FloatArray
    nuisance: FloatArray
    by: FloatArray
    own: FloatArray
    variance: FloatArray


class Trial(ABC):
    """A test that might be made.

    ``cost`` ranks tests by the work they make: 1 a look at the settings, or a caliper; 2 a balance; 3 a hit on a free
    mass, or a balance for which the specimen must come out of its clamp; 4 the same test once more; 5 with another
    point or sensor; 6 a test of the shapes where there is none; 7 the specimen hung up free; 8 another surrounding.
    """

    cost: int
    measure: str
    family: str

    @abstractmethod
    def outcomes(self, site: Site, rivals: tuple[Rival, ...]) -> tuple[Outcome, ...]:
        """Return what each rival expects, in terms that can be compared."""


class Maker(ABC):
    """A kind of test, and those of its kind that a specimen admits."""

    @abstractmethod
    def trials(self, site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
        """Give the tests worth a look."""


def separation(a: Outcome, b: Outcome, rival: Rival) -> float:
    """Return how many sigma ``b`` is off if ``a`` is right, its parameters and all nuisances having done their best.

    What the data so far leave of their freedom is in the rival's covariance, so this is the growth of the
    Mahalanobis distance of the joint fit.

    Parameters
    ----------
    a, b : Outcome
        What the truth and the rival expect.
    rival : Rival
        The rival.
    """
    columns = np.hstack([b.nuisance, b.by])
    noise = np.maximum(a.variance, b.variance)
    covariance = np.diag(noise) + columns @ rival.spread @ columns.T + b.own @ b.own.T
    difference = b.value - a.value
    sound = np.isfinite(difference) & np.isfinite(np.diag(covariance))
    if not sound.any():
        return 0.0
    difference, covariance = difference[sound], covariance[np.ix_(sound, sound)]
    return float(np.sqrt(max(float(difference @ np.linalg.solve(covariance, difference)), 0.0)))
