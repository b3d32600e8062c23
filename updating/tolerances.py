"""The modeller's own doubts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Tolerances:
    """The modeller's own doubts, relative standard deviations [-].

    Parameters
    ----------
    factors : mapping of str to float
        Tolerances of E, density, thickness, length, width.
    damping : float
        Doubt in the expected damping of each mode, half of its variance common to all modes.
    """

    factors: Mapping[str, float] = field(default_factory=dict)
    damping: float = 0.3
