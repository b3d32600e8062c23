"""What an effect does, whatever its story: in which channel, over which extent, and how large in a common currency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Channel = Literal["stiffness", "mass", "damping", "measurement"]

Extent = Literal["global", "local", "edge", "chain"]
"""All over the structure, at a place, at its supports, or in the measuring chain."""

ADDED_MASS = "added mass"
"""Of what sits at a place [kg]."""

INTEGRAL_COMPLIANCE = "compliance"
"""The integral of EI0/EI - 1 along the structure [m], of a support that turns EI/k: to first order a clamp that turns,
a soft place at its edge and a longer structure shift every mode alike if this is the same."""

STIFFNESS_RATIO = "relative stiffness"
"""Change of the stiffness over the model's own [-]."""

STIFFNESS_OVER_MASS = "relative stiffness over mass"
"""Change of stiffness over mass over the model's own [-]: that of all squared frequencies alike."""

MASS_RATIO = "relative mass"
"""Change of the mass over the model's own [-]."""

DAMPING_RATIO = "added damping ratio"
"""In the middle of the measured band [-]."""


@dataclass(frozen=True)
class Size:
    """How large an effect is in one currency.

    Parameters
    ----------
    quantity : str
        What is stated: two effects that state the same one can be compared.
    value : float
        Its value [unit].
    unit : str
        Its unit; ``-`` for a ratio.
    doubt : float
        Relative standard deviation of the scale that it is read on, which no datum shows [-].
    """

    quantity: str
    value: float
    unit: str
    doubt: float = 0.0
