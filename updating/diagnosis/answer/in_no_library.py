"""What an answer states about a cause outside the library."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from acquisition.display import Displayed
from acquisition.quantities import probability
from updating.diagnosis.answer.mechanism import Component

SOMETHING_ELSE = "something_else"
"""What stands for a cause in no library where a set names its effects."""


@dataclass(frozen=True)
class RegionalChange:
    """What a cause in no library would change in one region.

    Parameters
    ----------
    region : str
        Its name; empty for what is in no region.
    property : {"stiffness", "mass"}
        What is changed.
    percent, low95, high95 : float
        By how much, and the ends of the 95 % interval [%].
    """

    region: str
    property: Literal["stiffness", "mass"]
    percent: float
    low95: float
    high95: float

    def __str__(self) -> str:
        of = f"of {self.region}" if self.region else "outside all regions"
        return f"{self.property} {of} {self.percent:+.2g} % ({self.low95:+.2g} to {self.high95:+.2g})"


@dataclass(frozen=True)
class SomethingElse(Displayed):
    """A cause that is in no library: fields of stiffness and mass, of damping and of gains, compared as the sets are.

    Parameters
    ----------
    probability : float
        That it is the cause, and no set of the library, given that there is one [-].
    beside : float
        Logarithm of the Bayes factor of such a cause beside the first set: above 0 something is left [-].
    changes : tuple of RegionalChange
        What it would change of the structure where it is the cause, what is surest first; those of less than two
        standard deviations are left out.
    channels : mapping of str to float
        Probability that it changes stiffness, mass, damping, and the measurement, where it is the cause [-].
    parts : tuple of Component
        What it does where it is the cause, what is surest first.
    """

    probability: float
    beside: float
    changes: tuple[RegionalChange, ...]
    channels: Mapping[str, float] = field(default_factory=dict)
    parts: tuple[Component, ...] = ()

    def _headline(self) -> str:
        return f"{probability(self.probability)}: {', '.join(map(str, self.changes[:3])) or 'nothing of the structure'}"
