"""One specimen, its test, and its model: what every command above the rooms hands down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field

from acquisition.display import Displayed
from updating.environment import Environment
from updating.models import Spec
from updating.test_data.measured import Measured
from updating.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class Case(Displayed):
    """A test beside a model.

    Parameters
    ----------
    title : str
        For messages.
    spec : Spec
        The nominal model.
    measured : Measured
        The test.
    baseline : Measured, optional
        The same specimen tested before the effect was there.
    tolerances : Tolerances
        The modeller's doubts.
    environment : Environment
        What is stated about the surroundings.
    accepted : tuple of (name, values)
        Effects put into the model beforehand.
    since_baseline : tuple of int
        Which of them, by rank, came after the baseline; the others were there in it, too.
    baseline_stated : tuple of int
        Of which of them, by rank, the study states this; of the others it is taken by their kind.
    """

    title: str
    spec: Spec
    measured: Measured
    _: KW_ONLY
    baseline: Measured | None = None
    tolerances: Tolerances = field(default_factory=Tolerances)
    environment: Environment = field(default_factory=Environment)
    accepted: tuple[tuple[str, Mapping[str, float]], ...] = ()
    since_baseline: tuple[int, ...] = ()
    baseline_stated: tuple[int, ...] = ()

    @property
    def accepted_before(self) -> tuple[tuple[str, Mapping[str, float]], ...]:
        """The effects put into the model beforehand that were there in the baseline, too."""
        return tuple(one for i, one in enumerate(self.accepted) if i not in self.since_baseline)

    def _headline(self) -> str:
        baseline = "" if self.baseline is None else "; with a baseline"
        return f"{self.title}: {self.measured._headline()}; model: {self.spec._headline()}{baseline}"
