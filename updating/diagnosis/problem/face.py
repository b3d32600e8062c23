"""What can be diagnosed, one specimen or several: the face that the search sees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import Obstacle
from updating.likelihood.comparison import Comparison
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.problem.candidate import Candidate
from updating.test_data.measured import Measured

if TYPE_CHECKING:
    from updating.problem.specimen import SpecimenProblem


class DiagnosisProblem(Protocol):
    """A problem of one specimen or of several; where one has to stand for all, the first does."""

    @property
    def specimens(self) -> tuple[SpecimenProblem, ...]:
        """The problem of each specimen."""

    @property
    def predictor(self) -> Predictor:
        """The model of the first specimen."""

    @property
    def measured(self) -> Measured:
        """The test of the first specimen."""

    @property
    def nominal(self) -> Prediction:
        """The nominal prediction of the first specimen."""

    @property
    def wide(self) -> bool:
        """Whether tolerances are too wide for one linearisation."""

    def strain(self, shift: FloatArray) -> float:
        """Return the largest relative change that tolerances make of a property [-].

        ``shift`` holds those of every specimen, one after the other [standard deviations].
        """

    def applies(self, effect: Effect) -> Obstacle | None:
        """Return why an effect cannot be examined, or None."""

    def forms(self, effect: Effect) -> tuple[Variant, ...]:
        """Return the forms in which an effect may come."""

    def starts(self, candidate: Candidate) -> list[FloatArray]:
        """Return prior quantiles from which to search."""

    def parameters(self, candidate: Candidate) -> tuple[tuple[str, Parameter], ...]:
        """Return the parameters that are searched, as (effect.parameter, prior)."""

    def values(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, float]:
        """Return all values at prior quantiles, by effect.parameter."""

    def derived(self, candidate: Candidate, coordinates: FloatArray) -> dict[str, tuple[float, str]]:
        """Return derived quantities at prior quantiles, by effect.name."""

    def place(self, candidate: Candidate, coordinates: FloatArray) -> tuple[State, ...]:
        """Return the state of each specimen at prior quantiles."""

    def parts(self, candidate: Candidate, coordinates: FloatArray) -> tuple[list[tuple[Effect, Values]], ...]:
        """Return the effects on each specimen with their values at prior quantiles."""

    def at(
        self, candidate: Candidate, coordinates: FloatArray, shift: FloatArray | None = None
    ) -> Comparison:
        """Compare all data with a candidate at prior quantiles, linearised about some nuisances."""

    def compare(self, state: State) -> Comparison:
        """Compare all data with one state of every specimen."""
