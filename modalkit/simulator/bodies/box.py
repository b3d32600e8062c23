"""What beams, plates and solids of the rig have in common: dimensions, material, damping, and what surrounds them."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np

from acquisition.arrays import FloatArray


@dataclass(frozen=True)
class Box:
    """A box, its ends in the model's axes.

    Parameters
    ----------
    start, end : float
        Positions of its ends, or of a plate's edges x0 and x1 [m].
    width, thickness : float
        Extents along y and z [m].
    E, density : float
        Young's modulus, along x [Pa], and density [kg/m3].
    poisson : float
        Poisson's ratio [-].
    clamped : tuple of str
        Which ends are held: of ``x0``, ``x1``, of plates ``y0``, ``y1``; none is free.
    clamp_rotation : float
        Stiffness of each clamp, of a beam [N m/rad], of a plate per metre [N].
    alpha, beta : float
        Rayleigh damping that the modeller expects [1/s], [s].
    added_alpha, added_beta, added_loss : float
        Damping beside it: proportional to all mass, to the material's stiffness, and structural
        [1/s], [s], [-].
    """

    start: float
    end: float
    width: float
    thickness: float
    E: float
    density: float
    _: KW_ONLY
    poisson: float = 0.3
    clamped: tuple[str, ...] = ("x0",)
    clamp_rotation: float = np.inf
    alpha: float = 0.0
    beta: float = 0.0
    added_alpha: float = 0.0
    added_beta: float = 0.0
    added_loss: float = 0.0

    @property
    def length(self) -> float:
        """Free length, of a plate in the middle [m]."""
        return self.end - self.start

    @property
    def mass(self) -> float:
        """Mass of the box alone, uncut [kg]."""
        return self.density * self.width * self.thickness * self.length

    def middled(self, x: FloatArray) -> FloatArray:
        """Return places as shares of the length from the middle, -1/2 to 1/2 [-]."""
        return (x - self.start) / self.length - 0.5


@dataclass(frozen=True, kw_only=True)
class Surrounded(Box):
    """A box that varies along its length, under load, in a fluid.

    Parameters
    ----------
    clamp_translation : float
        Stiffness of each clamp, of a beam [N/m], of a plate per metre [N/m2]; what shifts goes on holding the slope.
    taper : float
        Relative change of thickness from start to end, about the middle [-].
    density_slope : float
        Relative change of density from start to end, about the middle [-].
    axial, axial_lean : float
        Tension along x, its mean [N]; its relative excess at the end and lack at the start, below one [-].
    rise : float
        Of a shallow arch (1 - cos(2 pi x / L)) / 2 between ends that do not part [m].
    fluid_density : float
        Density of the fluid all around [kg/m3].
    free_surface, bottom : float
        Distances of the fluid's surface above and of its bottom below the faces [m].
    drag : float
        Density times viscosity of the fluid whose boundary layer damps [kg2/(m4 s)].
    shear : bool
        False leaves out shear and rotary inertia: only for telling what they do.
    """

    clamp_translation: float = np.inf
    taper: float = 0.0
    density_slope: float = 0.0
    axial: float = 0.0
    axial_lean: float = 0.0
    rise: float = 0.0
    fluid_density: float = 0.0
    free_surface: float = np.inf
    bottom: float = np.inf
    drag: float = 0.0
    shear: bool = True
