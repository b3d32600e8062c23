"""The body of fluid around a flat structure: unbounded, or with a free surface, a bottom and side walls."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError


@dataclass(frozen=True)
class FluidDomain:
    """What bounds the fluid; everything left out is infinitely far away.

    Parameters
    ----------
    free_surface : float or None
        Height of the free surface (pressure zero, no gravity waves) above the upper face, towards +z. [m]
    bottom : float or None
        Depth of the rigid bottom below the lower face, towards -z. [m]
    walls : tuple of four floats or None
        Rigid upright walls x0, x1, y0, y1 in the model's axes, where a plate occupies x in [0, length] and
        y in [0, width]; a beam's centre line is y = 0. A wall that is not there is ``-inf`` or ``inf``; one
        at an edge lets no fluid round it, as at the root of a plate that is clamped in the wall. [m]

    Raises
    ------
    InputError
        If a distance is not positive or a pair of walls is in the wrong order.
    """

    free_surface: float | None = None
    bottom: float | None = None
    walls: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        """Check distances and the order of the walls."""
        for name, value in (("free_surface", self.free_surface), ("bottom", self.bottom)):
            if value is not None and not value > 0.0:
                raise InputError(
                    f"fluid domain: {name} is {value} m; give the distance from the structure, above zero"
                )
        if self.walls is None:
            return
        if len(self.walls) != 4 or any(math.isnan(wall) for wall in self.walls):
            raise InputError(f"fluid domain: walls is {self.walls}; give four numbers x0, x1, y0, y1 [m]")
        x0, x1, y0, y1 = self.walls
        if not (x0 < x1 and y0 < y1):
            raise InputError(f"fluid domain: walls {self.walls} are not in the order x0 < x1, y0 < y1")

    @property
    def nearest(self) -> float | None:
        """Distance of the nearer of free surface and bottom; None where there is neither. [m]"""
        there = [far for far in (self.free_surface, self.bottom) if far is not None and math.isfinite(far)]
        return min(there, default=None)

    def shifted(self, dy: float, *, dx: float = 0.0) -> FluidDomain:
        """Return the same domain seen from axes whose x and y are larger by ``dx`` and ``dy``. [m]"""
        if self.walls is None:
            return self
        x0, x1, y0, y1 = self.walls
        return FluidDomain(self.free_surface, self.bottom, (x0 + dx, x1 + dx, y0 + dy, y1 + dy))

    def stiffness(self, kappa: FloatArray, thickness: float) -> FloatArray:
        r"""Normal velocity per unit potential jump, for a harmonic of wavenumber ``kappa`` in x and y.

        Laplace's equation with zero potential at the free surface, a above, and zero normal velocity at the
        bottom, b below, gives the jump :math:`(\tanh \kappa a + \coth \kappa b)/\kappa` per unit velocity;
        without either, both terms are one. The fluid beside a thick plate adds the jump t along its straight
        path from face to face. The harmonic of wavenumber zero has no velocity: the fluid above the bottom
        cannot change its volume.

        Parameters
        ----------
        kappa : FloatArray
            Wavenumbers, any shape. [rad/m]
        thickness : float
            Thickness t of the plate. [m]

        Returns
        -------
        FloatArray
            As ``kappa``. [1/m]
        """
        kappa = np.maximum(kappa, 1e-150)
        above = 1.0 if self.free_surface is None else np.tanh(kappa * self.free_surface)
        below = 1.0 if self.bottom is None else 1.0 / np.tanh(kappa * self.bottom)
        return np.asarray(kappa / (above + below + thickness * kappa), dtype=np.float64)
