"""One specimen, its test, and its model: what every command above the rooms hands down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

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
        What is said of the surroundings.
    accepted : tuple of (name, values)
        Effects put into the model beforehand.
    """

    title: str
    spec: Spec
    measured: Measured
    baseline: Measured | None = None
    tolerances: Tolerances = field(default_factory=Tolerances)
    environment: Environment = field(default_factory=Environment)
    accepted: tuple[tuple[str, Mapping[str, float]], ...] = ()

    def _headline(self) -> str:
        baseline = "" if self.baseline is None else "; with a baseline"
        return f"{self.title}: {self.measured._headline()}; model: {self.spec._headline()}{baseline}"
