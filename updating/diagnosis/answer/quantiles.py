"""Quantiles of weighted samples."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray


def quantiles(values: FloatArray, weights: FloatArray) -> tuple[float, float, float]:
    """Return the 2.5, 50 and 97.5 % quantiles of samples (n,) with weights (n,), interpolated between samples."""
    order = np.argsort(values)
    share = (np.cumsum(weights[order]) - 0.5 * weights[order]) / weights.sum()
    low, middle, high = np.interp([0.025, 0.5, 0.975], share, values[order])
    return float(low), float(middle), float(high)
