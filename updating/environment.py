"""What a study states about the structure's surroundings."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Environment:
    """Fluid and its boundaries; all None is 'nothing stated'.

    Parameters
    ----------
    fluid_density : float, optional
        Density of the fluid around the structure [kg/m^3].
    free_surface, bottom : float, optional
        Distance of the free surface above (+z) and of the bottom below the structure [m].
    walls : tuple of 4 floats, optional
        Positions x0, x1, y0, y1 of the tank's walls in model axes [m].
    """

    fluid_density: float | None = None
    free_surface: float | None = None
    bottom: float | None = None
    walls: tuple[float, float, float, float] | None = None
