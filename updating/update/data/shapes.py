"""Mode shapes and modal constants as data: residuals with independent errors, and their sensitivities.

As shapes the constants of each mode are free of a factor; as constants they have their level, which the
calibration's error is part of.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from updating.update.data.nominal import Evaluation
from updating.update.data.specimen import Specimen


def shape_residual(specimen: Specimen, evaluation: Evaluation) -> FloatArray:
    """Return measured minus computed constants, as shapes with the best factor per mode, whitened (n,) [-]."""
    white, test = specimen.errors, specimen.measured.constants
    if specimen.level:
        computed = evaluation.prediction.constants
        return white((test - computed * specimen.measured.same_signs(computed)).ravel())
    span, _ = _factors(specimen, evaluation)
    measured = white(test.ravel())
    return np.asarray(measured - span @ (span.T @ measured))


def shape_slopes(specimen: Specimen, values: Sequence[float], evaluation: Evaluation) -> FloatArray:
    """Return the derivatives of the computed constants by the coordinates, whitened, (n, n_parameters) [-].

    The factors per mode are projected out (Golub and Pereyra 1973, with Kaufman's simplification).
    """
    slopes = specimen.shape_slopes(values, evaluation)
    if specimen.level:
        slopes = slopes * specimen.measured.same_signs(evaluation.prediction.constants)[:, None]
        return specimen.errors(slopes.reshape(-1, slopes.shape[2]))
    span, factor = _factors(specimen, evaluation)
    scaled = specimen.errors((slopes * factor[None, :, None]).reshape(-1, slopes.shape[2]))
    return np.asarray(scaled - span @ (span.T @ scaled))


def _factors(specimen: Specimen, evaluation: Evaluation) -> tuple[FloatArray, FloatArray]:
    """Return an orthonormal basis of what the factors can do, (n, n_modes), and the best factors (n_modes,) [-]."""
    shape = evaluation.prediction.constants
    size = np.maximum(np.linalg.norm(shape, axis=0), 1e-300)
    rows, modes = shape.shape
    block = np.zeros((rows, modes, modes))
    block[:, np.arange(modes), np.arange(modes)] = shape / size
    span, triangle = np.linalg.qr(specimen.errors(block.reshape(-1, modes)))
    best = np.linalg.solve(triangle, span.T @ specimen.errors(specimen.measured.constants.ravel()))
    return span, np.asarray(best / size)
