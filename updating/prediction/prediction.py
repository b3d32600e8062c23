"""Modes that a model predicts for the points of a test."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.display import Displayed


@dataclass(frozen=True, eq=False, kw_only=True)
class Prediction(Displayed):
    """Modes of a model at the points of a test.

    Parameters
    ----------
    frequency : (n_modes,) array
        Natural frequencies, nan where the state has lost its stiffness [Hz].
    damping : (n_modes,) array
        Damping ratios, nan where nothing is expected [-].
    constants : (n_frf, n_modes) array
        Modal constants phi_response * phi_reference, the gain included [1/kg].
    seen, hit : (n_frf, n_modes) arrays
        Mode shapes at the response and at the force of every FRF; 1 where no force is known [kg^-1/2].
    seen_slopes, hit_slopes : (d, n_frf, n_modes) arrays
        Their derivatives by the position of the sensor, and of the hit, along each axis; 0 where there is none
        [1/(kg^1/2 m)]. Then their changes per standard deviation of which of several nodes at the point is meant
        [kg^-1/2].
    log_frequency_by : (n_modes, n_factors) array
        Derivatives of ln f by the logarithms of the factors and masses asked for [-], and by bodies' places [1/m].
    constants_by : (n_frf, n_modes, n_factors) array
        Derivatives of the constants by the same [1/kg, 1/(kg m)].
    vectors : (r, n_modes) array
        Mode shapes in the coordinates of the reduced basis [kg^-1/2].
    slope : (n_modes,) array
        Relative change of each frequency per newton of the hits' peak force [1/N].
    gain : (n_frf, n_modes) array
        Factor of the constants over the product of the shapes at the points that they join [-].
    phase : (n_chains, n_modes) array, optional
        Where dampers couple modes: by how much the complex constants that each measurement chain sees were turned to
        be the real ones above; left out, not at all [rad].
    """

    frequency: FloatArray
    damping: FloatArray
    constants: FloatArray
    seen: FloatArray
    hit: FloatArray
    seen_slopes: FloatArray
    hit_slopes: FloatArray
    log_frequency_by: FloatArray
    constants_by: FloatArray
    vectors: FloatArray
    slope: FloatArray
    gain: FloatArray
    phase: FloatArray | None = None

    def select(self, modes: IntArray) -> Prediction:
        """Return some of the modes, in the order given."""
        return Prediction(
            frequency=self.frequency[modes],
            damping=self.damping[modes],
            constants=self.constants[:, modes],
            seen=self.seen[:, modes],
            hit=self.hit[:, modes],
            seen_slopes=self.seen_slopes[:, :, modes],
            hit_slopes=self.hit_slopes[:, :, modes],
            log_frequency_by=self.log_frequency_by[modes],
            constants_by=self.constants_by[:, modes],
            vectors=self.vectors[:, modes],
            slope=self.slope[modes],
            gain=self.gain[:, modes],
            phase=None if self.phase is None else self.phase[:, modes],
        )

    def overlap(self, other: Prediction) -> FloatArray:
        """Return the squared products of the modes with another state's, what hangs on either left out, (n, m) [-]."""
        size = min(len(self.vectors), len(other.vectors))
        return np.asarray((self.vectors[:size].T @ other.vectors[:size]) ** 2)

    @cached_property
    def along(self) -> FloatArray:
        """Derivatives of the constants by the position of the hit, 0 where none is known, (dim, n_frf, n_modes)."""
        return np.asarray(self.gain * self.seen * self.hit_slopes)
