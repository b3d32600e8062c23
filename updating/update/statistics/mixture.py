"""Several solutions weighted against one another: a mixture of normal distributions, one about each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from acquisition.arrays import FloatArray

NOTICED = 0.01
"""Solutions of less weight than this are not reported [-]."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """What data and tolerances leave of the parameters, where they leave more than one place.

    Parameters
    ----------
    weight : (m,) array
        Weights of the solutions, the reported one first; together 1 [-].
    centre : (m, p) array
        Their coordinates.
    covariance : (m, p, p) array
        Covariances about them.
    """

    weight: FloatArray
    centre: FloatArray
    covariance: FloatArray

    @property
    def solutions(self) -> int:
        """Number of solutions that matter."""
        return int(np.sum(self.weight > NOTICED))

    def error(self) -> FloatArray:
        """Return the mean square error of the reported solution, (p, p)."""
        away = self.centre - self.centre[0]
        return np.asarray(
            np.einsum("m,mij->ij", self.weight, self.covariance + away[:, :, None] * away[:, None, :])
        )

    def interval(self, level: float = 0.95) -> FloatArray:
        """Return the ends between which each coordinate lies, equal tails beyond them, (p, 2)."""
        sigma = np.sqrt(np.einsum("mii->mi", self.covariance))
        wanted = np.array([(1 - level) / 2, (1 + level) / 2])
        low = np.tile(np.min(self.centre - 9 * sigma, axis=0)[:, None], 2)
        high = np.tile(np.max(self.centre + 9 * sigma, axis=0)[:, None], 2)
        for _ in range(60):
            middle = (low + high) / 2
            below = ndtr((middle[None] - self.centre[..., None]) / np.maximum(sigma, 1e-300)[..., None])
            under = np.einsum("m,mpe->pe", self.weight, below) < wanted
            low, high = np.where(under, middle, low), np.where(under, high, middle)
        return np.asarray((low + high) / 2)


def laplace(cost: FloatArray, centre: FloatArray, covariance: FloatArray) -> Mixture:
    """Weigh solutions by exp(-cost / 2) and the volume about each (Laplace's method).

    Parameters
    ----------
    cost : (m,) array
        Misfit of each in variances, tolerances included; the reported solution first [-].
    centre, covariance : (m, p) and (m, p, p) arrays
        Coordinates of the solutions and covariances about them.
    """
    log = -0.5 * cost + 0.5 * np.linalg.slogdet(covariance)[1]
    weight = np.exp(log - log.max())
    return Mixture(weight / weight.sum(), centre, covariance)
