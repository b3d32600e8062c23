"""Mode shapes as data: residuals up to a factor per mode, and their sensitivities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.update.specimen import Look, Specimen


def _scale(specimen: Specimen, look: Look) -> FloatArray:
    """Return the factor that brings each predicted shape nearest to the measured one, (n_modes,) [-]."""
    weight, shape = specimen.shape_weight, look.prediction.constants
    fit = np.sum(weight * specimen.measured.constants * shape, axis=0)
    return np.asarray(fit / np.maximum(np.sum(weight * shape**2, axis=0), 1e-300))


def shape_residual(specimen: Specimen, look: Look) -> FloatArray:
    """Return measured minus computed shapes with the best factor per mode, (n_frf, n_modes) [1/kg]."""
    return np.asarray(specimen.measured.constants - _scale(specimen, look) * look.prediction.constants)


def shape_slopes(specimen: Specimen, values: Sequence[float], look: Look) -> FloatArray:
    """Return the derivatives of the computed shapes by the coordinates, (n_frf * n_modes, n_knobs).

    The factors per mode are projected out (Golub and Pereyra 1973, with Kaufman's simplification).
    """
    slopes = specimen.shape_slopes(values, look)
    weight, shape = specimen.shape_weight, look.prediction.constants
    along = np.sum((weight * shape)[..., None] * slopes, axis=0) / np.sum(weight * shape**2, axis=0)[:, None]
    across = _scale(specimen, look)[:, None] * (slopes - shape[..., None] * along)
    return np.asarray(across.reshape(-1, across.shape[2]))


def shape_ratios(specimen: Specimen, look: Look, parameters: int) -> FloatArray:
    """Return by what factor the misfit of each mode's shape exceeds its variance, 1 or more, (n_modes,) [-].

    The square of Birge's ratio, mode by mode: what the model's shape cannot do is not in the identification's
    standard deviations. Residuals smaller than stated prove nothing, as the errors along a shape are not
    independent.
    """
    misfit = specimen.shape_weight * shape_residual(specimen, look) ** 2
    rows, modes = misfit.shape
    ratio = np.sum(misfit, axis=0) / max(rows - 1 - parameters / modes, 1.0)
    return np.asarray(np.maximum(ratio, 1.0))
