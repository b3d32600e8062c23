"""What an answer states whatever the story is: in which channel, over which extent, where, and how large."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from acquisition.quantities import estimate, place, probability
from updating.effects.box import Place
from updating.effects.mechanism import ADDED_MASS, Channel, Extent

Level = Literal["story", "mechanism"]
"""One set of effects is named, or what several of them do alike."""

Quantity = tuple[str, str]
"""What is stated, and its unit."""


@dataclass(frozen=True, eq=False)
class Component(Displayed):
    """What one effect of a set does, or a cause in no library, by posterior samples.

    Parameters
    ----------
    channel : str
        stiffness, mass, damping or measurement.
    extent : {"global", "local", "edge", "chain"}
        All over the structure, at a place, at its supports, in the measuring chain.
    weights : (n,) array
        Posterior weights, summing to 1 [-].
    sizes : mapping of (quantity, unit) to (n,) array
        How large it is in each of its currencies, the one that suits it first [unit].
    places : (n, 3) array, optional
        Where it is, of several places that fit alike the one nearest to the best; None where it has no place [m].
    count : int
        In how many places it is at the same time.
    doubts : mapping of (quantity, unit) to float
        Relative standard deviations of the scales that sizes are read on; none where a currency is not listed [-].
    """

    channel: Channel
    extent: Extent
    weights: FloatArray
    sizes: Mapping[Quantity, FloatArray]
    places: FloatArray | None = None
    count: int = 1
    doubts: Mapping[Quantity, float] | None = None


@dataclass(frozen=True)
class MechanismSize:
    """How large a mechanism is, over all sets that have it.

    Parameters
    ----------
    quantity, unit : str
        What is stated, and its unit.
    value, low95, high95 : float
        Posterior median and the ends of the 95 % interval [unit].
    """

    quantity: str
    unit: str
    value: float
    low95: float
    high95: float

    def __str__(self) -> str:
        factor = 100.0 if self.unit == "-" and self.quantity.startswith("relative") else 1.0
        unit = "%" if factor > 1 else self.unit
        text = estimate(factor * self.value, unit, factor * self.low95, factor * self.high95)
        return text if self.quantity == ADDED_MASS else f"{self.quantity} {text}"


@dataclass(frozen=True)
class Alike:
    """One set of effects that has a mechanism, with its probability given that there is a cause [-]."""

    effects: tuple[str, ...]
    probability: float


@dataclass(frozen=True, kw_only=True)
class Mechanism(Displayed):
    """What all sets that share it do alike.

    Parameters
    ----------
    channel, extent : str
        As of :class:`Component`.
    location : tuple of float, optional
        The most probable place [m].
    locations : tuple of tuple of float
        All places that fit, mirrored ones too, and those that it is in at the same time, most probable first [m].
    location_low95, location_high95 : tuple of float, optional
        Ends of the 95 % intervals of the coordinates about ``location`` [m].
    size : MechanismSize, optional
        How large it is; None where the sets have no currency in common.
    probability : float
        Of all sets that have it together, a cause in no library among them, given that there is a cause [-].
    sets : tuple of Alike
        These sets, most probable first.
    """

    channel: Channel
    extent: Extent
    location: Place | None
    locations: tuple[Place, ...]
    location_low95: Place | None
    location_high95: Place | None
    size: MechanismSize | None
    probability: float
    sets: tuple[Alike, ...]

    def _headline(self) -> str:
        return f"{self} ({probability(self.probability)})"

    def __str__(self) -> str:
        """State channel, place and size: ``mass near x = 130 mm, 50.7 g (49.4 to 52)``."""
        return f"{self.channel} {self.where}" + (f", {self.size}" if self.size else "")

    @property
    def where(self) -> str:
        """Where it is, as text."""
        if not self.locations:
            return "of all points alike" if self.extent == "chain" else "of the whole structure"
        places = " and ".join(dict.fromkeys(place(at) for at in self.locations[:3]))
        return f"{'near' if self.extent == 'local' else 'at'} {places}"


@dataclass(frozen=True)
class Levels:
    """At which level an answer is certain, and its mechanisms.

    Parameters
    ----------
    level : {"story", "mechanism"} or None
        One set of effects is named; or what sets of the answer do alike is certain, the set is not; or neither.
    mechanisms : tuple of Mechanism
        What the most probable set, or a cause in no library, does: all at the same time, the leading one first; empty
        where there is nothing to state.
    """

    level: Level | None = None
    mechanisms: tuple[Mechanism, ...] = ()
