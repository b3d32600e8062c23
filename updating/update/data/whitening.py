"""Errors that data share: a covariance of single errors and common causes, and its square root."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray

FAINT = 1e-9
"""Common causes under this share of the single errors are none [-]."""


@dataclass(frozen=True, eq=False)
class Whitening:
    """The covariance diag(sigma^2) + C C' of some data, and what makes them independent with variance 1.

    Parameters
    ----------
    sigma : (n,) array
        Standard deviations that are each datum's own [unit of the data].
    common : (n, k) array
        What one standard deviation of each common cause does to them [unit of the data].
    left : (n, k) array
        Directions of the common causes in units of ``sigma``, orthonormal [-].
    size : (k,) array
        Their standard deviations in these units [-].
    """

    sigma: FloatArray
    common: FloatArray
    left: FloatArray
    size: FloatArray

    def __call__(self, values: FloatArray) -> FloatArray:
        """Return (I + V V')^(-1/2) diag(sigma)^-1 values, for values of shape (n,) or (n, m) [-]."""
        scaled = values / (self.sigma if values.ndim == 1 else self.sigma[:, None])
        shrink = 1 / np.sqrt(1 + self.size**2) - 1
        along = self.left.T @ scaled
        return np.asarray(scaled + self.left @ ((shrink if values.ndim == 1 else shrink[:, None]) * along))

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw errors with this covariance, shape (n,) [unit of the data]."""
        own, causes = rng.standard_normal(len(self.sigma)), rng.standard_normal(self.common.shape[1])
        return np.asarray(self.sigma * own + self.common @ causes)


def whitening(sigma: FloatArray, common: FloatArray) -> Whitening:
    """Return the square root of diag(sigma^2) + C C' by the singular values of the common part."""
    scaled = common / sigma[:, None]
    seen = np.linalg.norm(scaled, axis=0) > FAINT
    left, size, _ = np.linalg.svd(scaled[:, seen], full_matrices=False)
    return Whitening(sigma, common[:, seen], left, size)
