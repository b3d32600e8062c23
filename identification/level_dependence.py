"""How frequencies and damping follow the force of the hits, as found."""

from __future__ import annotations

from dataclasses import dataclass, replace

from acquisition.arrays import FloatArray, IntArray
from acquisition.display import Displayed


@dataclass(frozen=True, eq=False, kw_only=True)
class LevelDependence(Displayed):
    """How frequencies and damping follow the force of the hits.

    The level of a hit is the largest force in its record: what a user reads off his analyser, and, with one hammer
    and one tip, what every amplitude that follows is proportional to.

    Parameters
    ----------
    slope, slope_sigma : (n_modes,) arrays
        d ln f / dF of each mode at ``level`` and its standard deviation; nan where no hit shows the mode [1/N].
    damping_slope, damping_slope_sigma : (n_modes,) arrays
        d zeta / dF, likewise [1/N].
    level : float
        The level that the averaged FRFs, and so the identified frequencies, stand for [N].
    weakest, strongest : float
        Range of the recorded levels [N].
    levels : (n_hits,) array
        Level of each used hit: by its record, and by the modes that follow it where these are two or more [N].
    point : (n_hits,) int array
        Which point and run each hit belongs to.
    shifts, sigmas : (n_hits, n_modes) arrays
        ln f of each hit less that identified, and the standard deviation by the misfit of this hit alone [-].
    damping_shifts, damping_sigmas : (n_hits, n_modes) arrays
        Damping ratio of each hit less that identified, and its standard deviation likewise [-].
    """

    slope: FloatArray
    slope_sigma: FloatArray
    damping_slope: FloatArray
    damping_slope_sigma: FloatArray
    level: float
    weakest: float
    strongest: float
    levels: FloatArray
    point: IntArray
    shifts: FloatArray
    sigmas: FloatArray
    damping_shifts: FloatArray
    damping_sigmas: FloatArray

    def modes(self, which: IntArray) -> LevelDependence:
        """Return the same of some of the modes, by their numbers ``which``, (n,)."""
        each = ("slope", "slope_sigma", "damping_slope", "damping_slope_sigma")
        changed = {name: getattr(self, name)[which] for name in each}
        of_hits = ("shifts", "sigmas", "damping_shifts", "damping_sigmas")
        changed |= {name: getattr(self, name)[:, which] for name in of_hits}
        return replace(self, **changed)
