"""What stands on the rig: a body with everything an effect may have done to it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

Box = tuple[float, float, float, float]
"""x0, x1, y0, y1 as shares of length and width [-]."""


@dataclass(frozen=True)
class Patch:
    """A layer stuck on a rectangle: it damps, weighs, and stiffens."""

    box: Box
    loss: float
    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True)
class Body:
    """A Timoshenko beam or a Mindlin plate as it really is.

    Parameters
    ----------
    kind : str
        beam or plate.
    length, width, thickness, E, density, poisson : float
        Of the body itself [SI].
    clamped : tuple of str
        Clamped edges.
    soft : tuple of (box, loss)
        Where bending stiffness is lost [-].
    masses : tuple of (x, y, kg, kg m^2)
        Point masses, at shares of length and width.
    springs : tuple of (x, y, N/m)
        Springs to ground, at shares of length and width.
    rotation, translation : float, optional
        Stiffness of the clamps; None is rigid [N m/rad, N/m; per metre of edge on plates].
    across : float
        Factor on the bending stiffness along y [-].
    axial : float
        Tension along x [N].
    taper : float
        Relative change of the thickness from the middle to the end x1 [-].
    ribs : tuple of (box, factor)
        Where bending stiffness is multiplied [-].
    fluid : float
        Density of the fluid on both faces [kg/m^3].
    drag : float
        Decay by a fluid's boundary layer: damping per area c sqrt(omega) [N s^1.5/m^3].
    patches : tuple of Patch
    alpha, beta, loss : float
        Damping added to the whole [1/s, s, -].
    """

    kind: str
    length: float
    width: float
    thickness: float
    E: float
    density: float
    poisson: float
    clamped: tuple[str, ...]
    soft: tuple[tuple[Box, float], ...] = ()
    masses: tuple[tuple[float, float, float, float], ...] = ()
    springs: tuple[tuple[float, float, float], ...] = ()
    rotation: float | None = None
    translation: float | None = None
    across: float = 1.0
    axial: float = 0.0
    taper: float = 0.0
    ribs: tuple[tuple[Box, float], ...] = ()
    fluid: float = 0.0
    drag: float = 0.0
    patches: tuple[Patch, ...] = ()
    alpha: float = 0.0
    beta: float = 0.0
    loss: float = 0.0

    def but(self, **changes: Any) -> Body:
        """Return the same body with changes."""
        return replace(self, **changes)

    def boxes(self) -> tuple[Box, ...]:
        """Return the rectangles whose edges the mesh must meet."""
        return (
            *(b for b, _ in self.soft),
            *(b for b, _ in self.ribs),
            *(p.box for p in self.patches),
        )

    @property
    def mass(self) -> float:
        """Mass of the bare body [kg]."""
        return self.density * self.length * self.width * self.thickness
