"""Standard deviations of what is reported, with what the fit leaves taken into account."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.pruning import constant_variance, pole_covariance
from identification.fit.equations.refine import scores
from identification.fit.fit import Fitted
from identification.fit.noise import window_shaped
from identification.fit.noise.common_spread import common_factors
from identification.fit.noise.disagreement import Disagreement, between_frfs
from identification.hit_errors import HitErrors
from identification.uncertainty.hit_scatter import NoiseFactors
from identification.uncertainty.hit_scatter import factors as hit_factors
from identification.uncertainty.line_scatter import line_factors
from identification.uncertainty.misfit import misfit_factor


def noise_factors(frfs: FrfSet, fitted: Fitted, modes: BoolArray) -> NoiseFactors:
    """Return by what factor the errors exceed those of independent noise of the weights' size.

    The hits tell where they came with the FRFs, noise that fades otherwise. What all hits have in common is
    not in their scatter, so the factor is never under what the fit leaves about a mode.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    fitted : Fitted
        The fit.
    modes : (n_modes,) bool array
        Which of its poles are modes.
    """
    fit, misfit = fitted.fit, misfit_factor(frfs, fitted)
    held, free, pole = window_shaped.inflation(fitted.weights.fade, (frfs.decay - fit.poles.real) / frfs.df)
    pole = pole * common_factors(frfs, fit, fitted.weights, fitted.variance, fitted.residual)
    shape = fit.linear.residues.shape
    noise = NoiseFactors(pole, np.broadcast_to(free, shape), np.ones(len(pole)), np.broadcast_to(held, shape))
    stated = hit_factors(frfs, fit, fitted.weights, modes, noise)
    lines = np.ones(len(pole)) if frfs.line_shape is None else line_factors(fitted)
    alone = np.maximum(misfit, lines)
    if stated is None:
        poles = np.maximum(
            misfit * noise.poles, lines
        )  # what lines scatter by holds what their FRFs have in common
        return NoiseFactors(poles, alone * noise.constants, noise.shapes, alone * noise.held)
    poles, constants = np.maximum(stated.poles, alone), np.maximum(stated.constants, alone)
    held = np.maximum(stated.held, alone)
    return NoiseFactors(poles, constants, stated.shapes, held, stated.by_hits)


def pole_statistics(fitted: Fitted, factors: NoiseFactors, separation: Disagreement) -> FloatArray:
    """Return the covariance of (ln frequency, damping ratio) of every mode, shape (n_modes, 2, 2) [-].

    First-order propagation from (Re p, Im p): f = |p| / 2 pi, zeta = -Re p / |p|; with what FRFs that disagree,
    ``separation``, add.
    """
    poles = fitted.fit.poles
    full = pole_covariance(fitted.fit).reshape(len(poles), 2, len(poles), 2)
    own = np.einsum("rarb->rab", full)
    own = own * factors.poles[:, None, None] + separation.mean
    a, b, size = poles.real, poles.imag, np.abs(poles)
    jacobian = np.stack(
        [
            np.stack([a, b], axis=1) / size[:, None] ** 2,
            np.stack([-(b**2), a * b], axis=1) / size[:, None] ** 3,
        ],
        axis=1,
    )
    return np.asarray(np.einsum("rab,rbc,rdc->rad", jacobian, own, jacobian))


def constant_statistics(fitted: Fitted, factors: NoiseFactors, separation: Disagreement) -> FloatArray:
    """Return the standard deviation of each modal constant's real part, shape (n_frf, n_modes) [1/kg].

    Where FRFs disagree on a pole, each constant bears the scatter of its own FRF's pole about the common one.
    """
    noise = constant_variance(fitted.fit) * factors.constants
    return np.asarray(np.sqrt(noise + _shifted(fitted, separation)))


def _shifted(fitted: Fitted, separation: Disagreement) -> FloatArray:
    """Return the variance of each constant by the scatter of its FRF's own pole, (n_frf, n_modes) [1/kg^2]."""
    fit = fitted.fit
    n = len(fit.poles)
    gain = fit.pole_gain.reshape(-1, n, n, 2)
    own = np.einsum("jnna->jna", gain)
    shift = np.einsum("jna,jnab,jnb->jn", own, separation.each, own)
    return np.asarray((2.0 * fit.poles.imag) ** 2 * np.maximum(shift, 0.0))


def shared_errors(fitted: Fitted, factors: NoiseFactors) -> FloatArray:
    """Return the errors of the constants' real parts that come from the poles, (n_frf, n_modes, k) [1/kg].

    One standard deviation of each of k independent causes: their covariance is the sum over the causes of
    products. An error of a mode's own pole stretches all its constants alike; that of a neighbour's adds
    something of the neighbour's shape.
    """
    fit = fitted.fit
    covariance = pole_covariance(fit)
    size = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
    half = (np.sqrt(np.repeat(factors.poles, 2)) * size)[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    moved = fit.pole_gain @ half
    return np.asarray(-2.0 * fit.poles.imag[:, None] * moved)


def own_errors(fitted: Fitted, factors: NoiseFactors, separation: Disagreement) -> FloatArray:
    """Return the standard deviation of each constant's real part with the poles known, (n_frf, n_modes) [1/kg]."""
    fit = fitted.fit
    held = (2.0 * fit.poles.imag) ** 2 * fit.residue_inverse[:, 1::2]
    return np.asarray(np.sqrt(held * factors.held + _shifted(fitted, separation)))


def hit_errors(fitted: Fitted, factors: NoiseFactors, modes: IntArray) -> HitErrors | None:
    """Return what each hit adds to the errors of the constants of some modes, or None where no hits are known."""
    if not factors.by_hits:
        return None
    fit = fitted.fit
    size = 2.0 * fit.poles.imag[modes]
    white = size * np.sqrt(fit.residue_inverse[:, 1::2][:, modes])
    freedom = np.zeros(len(white))
    groups: list[list[int]] = [[] for _ in freedom]
    parts: list[list[FloatArray]] = [[] for _ in freedom]
    for number, group in enumerate(factors.by_hits):
        freedom[group.rows] += len(group.alone) - 1.0
        for i, row in enumerate(group.rows.tolist()):
            groups[row].append(number)
            parts[row].append(-size * group.alone[:, i, modes])
    deviations = np.zeros((len(white), max(sum(map(len, part)) for part in parts), len(modes)))
    for row, part in enumerate(parts):
        together = np.concatenate([np.zeros((0, len(modes))), *part])
        deviations[row, : len(together)] = together
    known = {tuple(group): rank for rank, group in enumerate(map(tuple, groups))}
    hits = np.array([known[tuple(group)] for group in groups])
    return HitErrors(deviations, freedom, white, hits, misfit_factor(fitted.frfs, fitted)[modes])


def disagreement(fitted: Fitted, factors: NoiseFactors) -> Disagreement:
    """Return how far the FRFs disagree on each pole, beyond what the noise factors allow.

    What the drift explains was taken out before; what its estimate leaves in doubt comes on top: of the mean, as there
    are only so many set-ups, and of each FRF's own shift.
    """
    poles = fitted.fit.poles
    left = between_frfs(*scores(fitted.fit), factors.poles)
    drift, way = fitted.drift.at(poles), np.stack([poles.real, poles.imag], axis=1)
    along = way[:, :, None] * way[:, None, :]
    return Disagreement(
        left.mean + along * drift.mean_variance[:, None, None],
        left.each + along * drift.doubt[:, :, None, None],
        left.scatter,
    )
