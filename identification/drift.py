"""Frequencies that are a little other in every FRF, as a part of the model.

A sensor or hammer that roves loads the structure, a set-up is moved, temperature rises: the poles of FRF j are
p_r (1 + d_jr). Shifts are random effects about the common pole: a part common to all modes of what was measured
together (temperature), and one of each mode (a mass that roves). Their variances follow from how far the FRFs'
own frequencies scatter beyond noise (:func:`identification.disagreement.scatter_beyond_noise`), the shifts
are the conditional means, so that noise alone moves nothing. FRFs are then carried over to the common poles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import FloatArray, IntArray
from acquisition.frf import FrfSet
from identification import basis
from identification.arrangement import arrange
from identification.disagreement import scatter_beyond_noise
from identification.refine import Fit, frequency_scores
from identification.residues import synthesise
from identification.grams import Weights

_FEW = 3  # groups under which a scatter between them is no estimate
_LARGEST = 0.02
"""Largest shift believed, relative [-]: a structure that changes more is another structure. Twice as much changes
nothing where frequencies differ by per mille, as set-ups make them."""


@dataclass(frozen=True, eq=False)
class Drift:
    """Relative shifts of the frequencies of each FRF.

    Parameters
    ----------
    shift : (n_frf, n_modes) array
        Frequency of the mode in that FRF over the common one, less 1 [-].
    doubt : (n_frf, n_modes) array
        Variance of each shift given the data [-].
    variance : (n_modes,) array
        Variance of the shifts between the groups [-].
    mean_variance : (n_modes,) array
        Variance that the finite number of groups leaves in the common frequency, widened so that 1.96 standard
        deviations are a 95 % interval however few the groups are [-].
    """

    shift: FloatArray
    doubt: FloatArray
    variance: FloatArray
    mean_variance: FloatArray

    @classmethod
    def none(cls, n_frf: int, n_modes: int) -> Drift:
        """Return the drift of FRFs that agree."""
        return cls(np.zeros((n_frf, n_modes)), np.zeros((n_frf, n_modes)), np.zeros(n_modes), np.zeros(n_modes))


def setups(frfs: FrfSet) -> IntArray:
    """Return which FRFs were measured together, as a number for each, shape (n_frf,).

    Those of the same hits where the hits are known, else those of one point of the side that roves.
    """
    arrangement = arrange(frfs)
    label = np.zeros(len(frfs.values), dtype=np.int64)
    rows, columns = np.nonzero(arrangement.index >= 0)
    label[arrangement.index[rows, columns]] = rows
    if frfs.scatter is not None:
        for number, group in enumerate(frfs.scatter.hit_groups):
            label[group] = number
    return label


def estimate_drift(frfs: FrfSet, fit: Fit, weights: Weights, *, previous: Drift | None = None) -> Drift:
    """Estimate the shifts from what each FRF says of the frequencies, given those it was carried over by.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, carried over to common poles by ``previous`` where that is given.
    fit : Fit
        A fit to them.
    weights : Weights
        Reciprocal variances.
    previous : Drift, optional
        Shifts taken out already.
    """
    n_frf, n_modes = len(frfs.values), len(fit.poles)
    label = setups(frfs)
    n_groups = int(label.max()) + 1
    known = Drift.none(n_frf, n_modes) if previous is None else previous
    if n_groups < _FEW:
        return Drift.none(n_frf, n_modes)
    gradient, normal = frequency_scores(frfs, fit.poles, weights, fit.linear.powers)
    gradient = gradient + np.einsum("jnm,jm->jn", normal, known.shift)
    pulls, information = np.zeros((n_groups, n_modes)), np.zeros((n_groups, n_modes, n_modes))
    np.add.at(pulls, label, 2.0 * gradient)
    np.add.at(information, label, 2.0 * normal)
    omega = fit.poles.imag / (2 * np.pi)
    within = (omega >= frfs.frequency[0]) & (omega <= frfs.frequency[-1])
    own, variance = _own_shifts(pulls, information, within)
    common, each = _variances(own, variance)
    prior = common * np.outer(within, within) + np.diag(np.where(within, each, 0.0))
    given = np.linalg.solve(np.eye(n_modes) + information @ prior, np.broadcast_to(np.eye(n_modes), information.shape))
    posterior = prior @ given
    shift = np.clip(np.einsum("gnm,gm->gn", posterior, pulls), -_LARGEST, _LARGEST)
    total = np.diag(prior)
    return Drift(
        shift=shift[label],
        doubt=np.einsum("gnn->gn", posterior)[label],
        variance=total,
        mean_variance=total * _of_the_mean(np.einsum("gnn->gn", information)),
    )


def _own_shifts(
    pulls: FloatArray, information: FloatArray, within: np.ndarray
) -> tuple[FloatArray, FloatArray]:
    """Return each group's own shifts and their variances, infinite where it tells nothing, (n_groups, n_modes)."""
    diagonal = np.einsum("gnn->gn", information)
    seen = (diagonal > 1e-12 * diagonal.max(axis=0, initial=0.0)) & (diagonal > 0) & within
    length = np.where(seen, np.sqrt(np.where(seen, diagonal, 1.0)), np.inf)
    unit = information / (length[:, :, None] * length[:, None, :])
    unit[~seen] = np.eye(len(within))[np.nonzero(~seen)[1]]
    inverse = np.linalg.pinv(unit, rcond=1e-9, hermitian=True)
    variance = np.einsum("gnn->gn", inverse) / length**2
    own = np.einsum("gnm,gm->gn", inverse, pulls / length) / length
    return np.where(seen, own, 0.0), np.where(seen & (variance > 0), variance, np.inf)


def _variances(own: FloatArray, variance: FloatArray) -> tuple[float, FloatArray]:
    """Return the variance of the shifts common to all modes, and that of each mode beside it, (n_modes,) [-]."""
    weight = 1.0 / variance
    total = weight.sum(axis=1)
    mean = np.sum(weight * own, axis=1) / np.where(total > 0, total, 1.0)
    of_mean = np.where(total > 0, 1.0 / np.where(total > 0, total, 1.0), np.inf)
    common = float(scatter_beyond_noise(mean[:, None], of_mean[:, None])[0])
    if own.shape[1] == 1 or np.isfinite(of_mean).sum() < _FEW:
        common = 0.0
    taken = mean * common / (common + np.where(np.isfinite(of_mean), of_mean, 1.0))
    each = scatter_beyond_noise(own - taken[:, None], variance)
    return common, np.where(np.isfinite(variance).sum(axis=0) < _FEW, 0.0, each)


def _of_the_mean(information: FloatArray) -> FloatArray:
    """Return the variance of a weighted mean over the groups for unit variance, Student's width in it, (n_modes,)."""
    total = information.sum(axis=0)
    share = np.sum((information / np.where(total > 0, total, 1.0)) ** 2, axis=0)
    share = np.clip(share, 1.0 / len(information), 1.0)
    freedom = np.maximum(1.0 / share - 1.0, 1.0)
    return np.asarray(share * (stats.t.ppf(0.975, freedom) / stats.norm.ppf(0.975)) ** 2)


def carried_over(frfs: FrfSet, fit: Fit, drift: Drift) -> FrfSet:
    """Return FRFs as they would be with the common poles: own poles' contributions exchanged for the common ones'.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs as measured.
    fit : Fit
        Common poles and residues.
    drift : Drift
        Shifts.
    """
    moved = np.flatnonzero(np.any(drift.shift, axis=1))
    if len(moved) == 0:
        return frfs
    values, axis = np.array(frfs.values), basis.Axis.of(frfs)
    straight = synthesise(axis, fit.poles, fit.linear)
    alike, which = np.unique(drift.shift[moved], axis=0, return_inverse=True)
    for number, shift in enumerate(alike):
        rows = moved[which == number]
        linear = replace(fit.linear, residues=fit.linear.residues[rows], terms=fit.linear.terms[rows])
        own = synthesise(axis, fit.poles * (1.0 + shift), linear)
        values[rows] += straight[rows] - own
    return replace(frfs, values=values)
