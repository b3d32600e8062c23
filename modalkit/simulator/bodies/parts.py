"""What may be fixed to a beam, cut into it, or stuck on it."""

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
class Absorber:
    """A mass that hangs on the beam by a spring and a dashpot, free to move by itself.

    Parameters
    ----------
    x : float
        Position [m].
    mass : float
        [kg].
    stiffness, damping : float
        Between the mass and the beam [N/m], [N s/m].
    """

    x: float
    mass: float
    stiffness: float
    damping: float


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


@dataclass(frozen=True)
class Stretch:
    """A stretch with sharp ends whose section differs: a rectangular notch, a rib, a step, a layer.

    Parameters
    ----------
    x, extent : float
        Centre and whole length [m].
    bending, line : float
        Factors on bending stiffness and on mass per length [-].
    loss : float
        Loss factor of the stretch, K (1 + i loss) there [-].
    alpha, beta : float
        Viscous damping of the stretch, C = alpha M + beta K there [1/s], [s].
    """

    x: float
    extent: float
    bending: float = 1.0
    line: float = 1.0
    loss: float = 0.0
    alpha: float = 0.0
    beta: float = 0.0

    @property
    def window(self) -> tuple[float, float]:
        """From where to where it reaches [m]."""
        return self.x - self.extent / 2, self.x + self.extent / 2

    def inside(self, x: FloatArray) -> FloatArray:
        """Return 1 where ``x`` is in the stretch and 0 elsewhere [-]."""
        return np.where(np.abs(x - self.x) < self.extent / 2, 1.0, 0.0)

    @property
    def compliance(self) -> float:
        """Integral of EI0/EI - 1 over the stretch [m]."""
        return self.extent * (1.0 / self.bending - 1.0)
