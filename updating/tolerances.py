"""The modeller's own doubts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import log, sqrt

UNIFORM = sqrt(12.0)
"""Width over standard deviation of what lies anywhere between two bounds [-]."""

FACTOR_RANGE = (0.05, 20.0)
"""Bounds of every factor [-]."""

FREE = log(FACTOR_RANGE[1] / FACTOR_RANGE[0]) / UNIFORM
"""1-sigma of the logarithm of a factor that lies anywhere between them [-]."""


@dataclass(frozen=True)
class Tolerances:
    """The modeller's own doubts, relative standard deviations [-].

    Parameters
    ----------
    factors : mapping of str to float
        Tolerances of E, density, thickness, length, width.
    damping : float
        Doubt in the expected damping of each mode; half of its variance again is common to all modes.
    parts : mapping of str to float
        Of single parameters, by the names that an update has for them: ``web.E``.
    bounds : mapping of str to (float, float)
        Between which a parameter lies: a factor as a factor, what is none in its unit. A bounded parameter without a
        tolerance of its own lies anywhere between them.
    free : frozenset of str
        Properties of which nothing is known: an update is not pulled to their nominal values. In ``factors`` they have
        `FREE`, by which a diagnosis takes them.
    """

    factors: Mapping[str, float] = field(default_factory=dict)
    damping: float = 0.3
    parts: Mapping[str, float] = field(default_factory=dict)
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    free: frozenset[str] = frozenset()

    def of(self, name: str, general: str) -> float:
        """Return the tolerance of a parameter: its own, 0 for one that has bounds alone or is free, else that of the
        property.
        """
        if name in self.parts or name in self.bounds:
            return self.parts.get(name, 0.0)
        return 0.0 if general in self.free else self.factors.get(general, 0.0)

    def factor(self, name: str) -> float:
        """Return the 1-sigma of a factor's logarithm: by its tolerance, its bounds, or that of the property [-]."""
        if name in self.factors:
            return self.factors[name]
        if name in self.parts or name not in self.bounds:
            return self.of(name, name.rpartition(".")[2])
        low, high = self.bounds[name]
        return log(high / low) / UNIFORM if low > 0 else 0.0
