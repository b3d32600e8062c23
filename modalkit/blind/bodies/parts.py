"""What may be fixed to a beam or cut into it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray


@dataclass(frozen=True)
class Attached:
    """Something fixed to the beam at one place.

    Parameters
    ----------
    x : float
        Position [m].
    mass, inertia : float
        Mass [kg] and rotary inertia [kg m2].
    stiffness, damping : float
        Spring [N/m] and dashpot [N s/m] to the ground.
    """

    x: float
    mass: float = 0.0
    inertia: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class Notch:
    """A smooth local loss of bending stiffness, EI (1 - loss cos^2(pi (x - centre) / extent)).

    Parameters
    ----------
    x, extent : float
        Centre and whole width [m].
    loss : float
        Loss at the centre [-].
    """

    x: float
    extent: float
    loss: float

    def factor(self, x: FloatArray) -> FloatArray:
        """Return the factor on the bending stiffness at ``x`` [-]."""
        u = (x - self.x) / self.extent
        return np.where(np.abs(u) < 0.5, 1.0 - self.loss * np.cos(np.pi * u) ** 2, 1.0)

    @property
    def compliance(self) -> float:
        """Integral of EI0/EI - 1 over the notch [m]; closed form of the cosine-squared dip."""
        return self.extent * float(1.0 / np.sqrt(1.0 - self.loss) - 1.0)
