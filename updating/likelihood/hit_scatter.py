"""What the scatter of the hits is made of: hits beside their point, hits of uneven gain, and white noise.

The errors that the hits of one FRF make in its modal constants have the covariance

    S = diag(f_r w_r^2) + tau^2 / N sum_d s_d s_d^T + gamma^2 / N c c^T

over the modes. The slopes ``s`` of the constants by the place of the hit are those of `updating.prediction.misplaced`,
the constants ``c`` are measured, and ``w`` is what the fit's weights state. Only the sizes are unknown, and alike at
all points: the factors ``f_r``, the scatter of the places ``tau`` [m] and of the gain ``gamma`` [-]. That is a factor
analysis with known loadings. Expectation and maximisation finds its most probable sizes (Rubin and Thayer,
Psychometrika 47 (1982) 69-76).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from identification.hit_errors import HitErrors
from updating.prediction.misplaced import moved, stated_levels
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured


@dataclass(frozen=True, eq=False)
class HitScatter:
    """What the scatter of the hits is made of.

    Parameters
    ----------
    white : (n_frf, n_modes) array
        Standard deviation of each constant that no other shares [1/kg].
    place : (n_frf,) array
        That of the mean place of an FRF's hits [m].
    gain : (n_frf,) array
        That of their mean gain, relative [-].
    """

    white: FloatArray
    place: FloatArray
    gain: FloatArray


def own_variance(measured: Measured, scatter: HitScatter | None) -> FloatArray:
    """Return the variance of each constant that no other shares, (n_frf, n_modes) [1/kg^2].

    Where the hits determine it, it is the white part of their scatter, widened to what the imaginary parts show, which
    are zero for real modes, and what errors of neighbours' poles add to the shape.

    Parameters
    ----------
    measured : Measured
        The test.
    scatter : HitScatter or None
        What its scatter is made of; None where the hits do not determine it: all of the standard deviation is each
        constant's own.
    """
    if scatter is None:
        return measured.constants_sigma**2
    white = scatter.white**2 + (scatter.gain[:, None] * measured.constants) ** 2
    beside = np.zeros(white.shape[1]) if measured.shared is None else _beside(measured)[1]
    turned = np.zeros(white.shape[1]) if measured.quadrature is None else measured.quadrature
    return np.asarray(white + np.maximum(beside, turned - white.mean(axis=0)))


def level_errors(measured: Measured, scatter: HitScatter | None) -> FloatArray:
    """Return by how much the error of each mode's pole stretches all its constants, relative (1 sigma), (n_modes,) [-].

    Nothing where the hits do not determine it what else there is: then it is in the standard deviation of each.
    """
    if scatter is None or measured.shared is None:
        return np.zeros(measured.constants.shape[1])
    return _beside(measured)[0]


def _beside(measured: Measured) -> tuple[FloatArray, FloatArray]:
    """Return what errors of the poles do along each mode's shape, relative, and across it, a variance, (n_modes,)."""
    shared, constants = measured.shared, measured.constants
    assert shared is not None
    power = np.maximum(np.sum(constants**2, axis=0), np.finfo(float).tiny)
    along = np.einsum("jr,jrk->rk", constants, shared) / power[:, None]
    across = np.mean(np.sum((shared - constants[..., None] * along) ** 2, axis=2), axis=0)
    return np.sqrt(np.sum(along**2, axis=1)), np.asarray(across)


def hit_scatter(measured: Measured, prediction: Prediction) -> HitScatter | None:
    """Return what the scatter of a test's hits is made of, or None where the hits do not determine them.

    Parameters
    ----------
    measured : Measured
        The test.
    prediction : Prediction
        The model's modes, in the order of the measured ones.
    """
    errors = measured.hit_errors
    if errors is None or not np.any(errors.freedom > 0):
        return None
    constants = measured.constants
    by = moved(measured, prediction, stated_levels(measured, prediction), constants)
    slopes = np.moveaxis(by.first[: measured.points.shape[1]], 0, -1)
    loadings = np.concatenate([slopes, constants[:, :, None]], axis=2)
    if loadings.shape[1] <= loadings.shape[2]:
        return None
    factor, spread = _sizes(errors, loadings)
    hits = np.maximum(errors.count(), 1)
    return HitScatter(
        errors.white * np.sqrt(factor * errors.misfit), np.sqrt(spread[0] / hits), np.sqrt(spread[-1] / hits)
    )


def _sizes(
    errors: HitErrors, loadings: FloatArray, *, steps: int = 200, settled: float = 1e-3, pooled: float = 10.0
) -> tuple[FloatArray, FloatArray]:
    """Return the factors on the white variance (n_modes,) and the variances of the loadings for one hit, (q,).

    Parameters
    ----------
    errors : HitErrors
        What each hit adds.
    loadings : (n_frf, n_modes, q) array
        Slopes by place, and the constants.
    steps : int
        At most so many steps.
    settled : float
        Relative change of every variance in one step at which they end [-].
    pooled : float
        Degrees of freedom that the factor of all modes counts as in that of each [-].
    """
    known = errors.freedom > 0
    weight, hits = errors.freedom[known], errors.count()[known]
    loads, white = loadings[known], errors.white[known] ** 2
    moved = errors.deviations[known]
    axes = loads.shape[2] - 1
    factor = np.ones(white.shape[1])
    # to begin with, either may make half of what is seen
    power = np.einsum("j,jhr,jr->", weight, moved**2, 1 / white) / 2
    by = np.array(
        [
            np.einsum("j,jrq,jr->", weight / hits, loads[:, :, part] ** 2, 1 / white)
            for part in (slice(0, axes), slice(axes, None))
        ]
    )
    place, gain = np.divide(power, 2 * by, out=np.zeros_like(by), where=by > 0)
    for _ in range(steps):
        # expectation: what each loading and each constant by itself has in the errors, given the sizes so far
        spread = np.append(np.full(axes, place), gain)
        second, left = _expected(moved, loads, factor * white, spread[None, :] / hits[:, None])
        # maximisation: their mean squares over all points; each mode's factor is drawn to that of all
        sizes = np.einsum("j,jq->q", weight * hits, second) / weight.sum()
        ratio = np.einsum("j,jr->r", weight, left / white)
        new = (ratio + pooled * ratio.mean() / weight.sum()) / (weight.sum() + pooled)
        new_place, new_gain = float(np.mean(sizes[:axes])), float(sizes[axes])
        still = np.allclose(
            [*new, new_place, new_gain], [*factor, place, gain], rtol=settled, atol=np.finfo(float).tiny
        )
        factor, place, gain = new, new_place, new_gain
        if still:
            break
    return factor, np.append(np.full(axes, place), gain)


def _expected(
    moved: FloatArray, loads: FloatArray, white: FloatArray, spread: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what is expected of the loadings' amounts, given the errors that the hits make.

    Parameters
    ----------
    moved : (n, n_hits, n_modes) array
        Errors of the constants by each hit; their products add up to a covariance.
    loads : (n, n_modes, q) array
        Loadings.
    white : (n, n_modes) array
        Variance of what each constant has for itself.
    spread : (n, q) array
        Variances of the amounts.

    Returns
    -------
    second : (n, q) array
        Expected squares of the amounts, added up over the hits.
    left : (n, n_modes) array
        Expected squares of what is each constant's own, added up over the hits.
    """
    weighted = loads / white[:, :, None]
    inner = np.einsum("jrq,jrp->jqp", weighted, loads)
    root = np.sqrt(spread)
    # (1/spread + inner)^-1, in a form that bears a spread of zero
    scaled = np.eye(loads.shape[2]) + root[:, :, None] * inner * root[:, None, :]
    covariance = root[:, :, None] * np.linalg.inv(scaled) * root[:, None, :]
    amounts = np.einsum("jqp,jrp,jhr->jhq", covariance, weighted, moved, optimize=True)
    second = np.sum(amounts**2, axis=1) + np.einsum("jqq->jq", covariance)
    rest = moved - np.einsum("jrq,jhq->jhr", loads, amounts)
    left = np.sum(rest**2, axis=1) + np.einsum("jrq,jqp,jrp->jr", loads, covariance, loads, optimize=True)
    return second, left
