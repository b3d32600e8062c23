"""Frequencies that are a little other in every FRF, as a part of the model.

A sensor or hammer that roves loads the structure, a set-up is moved, temperature rises: the poles of FRF j are
p_r (1 + d_jr). Shifts are random effects about the common pole: a part common to all modes of what was measured
together (temperature), and one of each mode (a mass that roves). Their variances follow from how far the FRFs'
own frequencies scatter beyond noise (:func:`identification.fit.noise.disagreement.scatter_beyond_noise`), the shifts
are the conditional means, so that noise alone moves nothing. FRFs are then carried over to the common poles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, squared
from acquisition.frfs.frf import FrfSet
from identification.arrangement import arrange
from identification.fit.equations import basis
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.refine import Fit, frequency_scores
from identification.fit.equations.residues import synthesise
from identification.fit.noise.common_spread import common_factors
from identification.fit.noise.disagreement import scatter_beyond_noise, student_widening
from identification.fit.noise.weights import decay_over_record, left_over
from identification.fit.noise.window_shaped import inflation

_FEW, _FEW_OF_ONE = 3, 6
"""Groups under which no scatter between them is estimated: of shifts that all modes share, and of those of one mode,
where one FRF in which the model does not hold would pass for a drift of all. Twice as many leave small tests to
:func:`identification.fit.noise.disagreement.between_frfs`."""
_CHANCE, _CHANCE_OF_ONE = 0.01, 1e-3
"""Chance by which noise alone passes for a drift of all modes, and for one of a mode by itself: there are as many tests
as modes, and what is missed is no larger than the noise. Twice as much finds hardly more."""
LARGEST = 0.02
"""Largest shift believed, relative [-]: a structure that changes more is another structure. Twice as much changes
nothing where frequencies differ by per mille, as set-ups make them."""


@dataclass(frozen=True, eq=False)
class Drift:
    """Relative shifts of the frequencies of each FRF.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Common poles it was estimated at [rad/s].
    shift : (n_frf, n_modes) array
        Frequency of the mode in that FRF over the common one, less 1 [-].
    common : (n_frf,) array
        Part of the shifts that all modes share: what a mode not known yet moves by [-].
    doubt : (n_frf, n_modes) array
        Variance of each shift given the data [-].
    variance : (n_modes,) array
        Variance of the shifts between the groups [-].
    mean_variance : (n_modes,) array
        Variance that the finite number of groups leaves in the common frequency, widened so that 1.96 standard
        deviations are a 95 % interval however few the groups are [-].
    raw, raw_variance : (n_frf, n_modes) arrays
        Each shift as the FRFs measured together show it by themselves, and its variance by their noise, infinite where
        they show nothing: what a course over the test is fitted to, since shifts held to a mean are too small [-].
    """

    poles: ComplexArray
    shift: FloatArray
    common: FloatArray
    doubt: FloatArray
    variance: FloatArray
    mean_variance: FloatArray
    raw: FloatArray
    raw_variance: FloatArray

    @classmethod
    def none(cls, n_frf: int, poles: ComplexArray) -> Drift:
        """Return the drift of FRFs that agree."""
        wide, flat = np.zeros((n_frf, len(poles))), np.zeros(len(poles))
        return cls(poles, wide, np.zeros(n_frf), wide, flat, flat, wide, np.full_like(wide, np.inf))

    @classmethod
    def common_to(cls, poles: ComplexArray, shift: FloatArray) -> Drift:
        """Return the drift of FRFs in which all poles are shifted alike, (n_frf,) [-]."""
        wide = np.repeat(shift[:, None], len(poles), axis=1)
        size = np.full(len(poles), float(np.var(shift)))
        return replace(cls.none(len(shift), poles), shift=wide, common=shift, variance=size)

    def at(self, poles: ComplexArray) -> Drift:
        """Return the drift of other poles: of the nearest known ones, or what all modes share."""
        if len(self.poles) == 0:
            return Drift.none(len(self.common), poles)
        distance = np.abs(poles[:, None] - self.poles[None, :])
        near = distance.argmin(axis=1)
        known = distance.min(axis=1) < np.abs(poles.real)
        return Drift(
            poles=poles,
            shift=np.where(known, self.shift[:, near], self.common[:, None]),
            common=self.common,
            doubt=np.where(known, self.doubt[:, near], 0.0),
            variance=np.where(known, self.variance[near], 0.0),
            mean_variance=np.where(known, self.mean_variance[near], 0.0),
            raw=np.where(known, self.raw[:, near], 0.0),
            raw_variance=np.where(known, self.raw_variance[:, near], np.inf),
        )


def blurred_by(drift: Drift, modes: BoolArray) -> bool:
    """Return whether all frequencies moved together by more than half the width of the sharpest of some (n_modes,).

    A mode that is not known yet is then a row of peaks, and may be missed.
    """
    half_width = np.abs(drift.poles.real / drift.poles)[modes]
    return bool(modes.any() and np.ptp(drift.common) > half_width.min())


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


def measuring_order(frfs: FrfSet) -> IntArray:
    """Return the place of each FRF in measuring order, from 0; those measured together share one, (n_frf,)."""
    _, first, group = np.unique(setups(frfs), return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first))[group])


def estimate_drift(
    frfs: FrfSet, fit: Fit, weights: Weights, *, own: BoolArray, previous: Drift | None = None
) -> Drift:
    """Estimate the shifts from the information of each FRF on the frequencies, given those it was carried over by.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, carried over to common poles by ``previous`` where that is given.
    fit : Fit
        A fit to them.
    weights : Weights
        Reciprocal variances it was made with.
    own : (n_modes,) bool array
        Which modes may have shifts of their own beside those common to all: poles that share one peak may not,
        as each would follow what the other leaves.
    previous : Drift, optional
        Shifts taken out already.
    """
    n_frf = len(frfs.values)
    known = (Drift.none(n_frf, fit.poles) if previous is None else previous).at(fit.poles)
    if int(setups(frfs).max()) + 1 < _FEW:
        return Drift.none(n_frf, fit.poles)
    gradient, normal = frequency_scores(fit)
    believed = _believed(frfs, fit, weights)
    found = _from_scores(frfs, fit, weights, own, known, gradient, normal, believed)
    if not found.variance.any():
        return found
    residual = left_over(frfs, fit)
    spread = common_factors(frfs, fit, weights, 1.0 / weights.full, residual)
    if spread.max() <= 1.0:
        return found
    return _from_scores(frfs, fit, weights, own, known, gradient, normal, believed / np.sqrt(spread))


def _from_scores(
    frfs: FrfSet,
    fit: Fit,
    weights: Weights,
    own: BoolArray,
    known: Drift,
    gradient: FloatArray,
    normal: FloatArray,
    believed: FloatArray,
) -> Drift:
    """Estimate the shifts from the scores of the frequencies, each FRF believed as far as is stated."""
    label, n_modes = setups(frfs), len(fit.poles)
    n_groups = int(label.max()) + 1
    normal = believed[:, :, None] * normal * believed[:, None, :]
    gradient = believed**2 * gradient + np.einsum("jnm,jm->jn", normal, known.shift)
    pulls, information = np.zeros((n_groups, n_modes)), np.zeros((n_groups, n_modes, n_modes))
    np.add.at(pulls, label, 2.0 * gradient)
    np.add.at(information, label, 2.0 * normal)
    omega = fit.poles.imag / (2 * np.pi)
    within = (omega >= frfs.frequency[0]) & (omega <= frfs.frequency[-1])
    window_shaped_noise = inflation(weights.fade, decay_over_record(frfs, fit.poles))[2][within].max(
        initial=1.0
    )
    reach = (frfs.decay - fit.poles.real) / np.abs(fit.poles)
    common = _common_variance(
        pulls @ within / window_shaped_noise, within @ information @ within / window_shaped_noise
    )
    each = np.zeros(n_modes)
    if (own & within).any():
        each = _own_variances(pulls, information, own & within, common, reach)
    prior = common * np.outer(within, within) + np.diag(each)
    given = np.linalg.inv(np.eye(n_modes) + information @ prior)
    posterior = prior @ given
    shift = np.clip(np.einsum("gnm,gm->gn", posterior, pulls), -LARGEST, LARGEST)
    total = np.diag(prior)
    shared = common * np.einsum("gnm,gm->gn", given, pulls) @ within
    raw, raw_variance = _own_shifts(pulls, information, within, reach)
    return Drift(
        poles=fit.poles,
        shift=shift[label],
        common=np.clip(shared, -LARGEST, LARGEST)[label],
        doubt=np.einsum("gnn->gn", posterior)[label],
        variance=total,
        mean_variance=total * _of_the_mean(np.einsum("gnn->gn", information), total, common),
        raw=raw[label],
        raw_variance=window_shaped_noise * raw_variance[label],
    )


def _believed(frfs: FrfSet, fit: Fit, weights: Weights) -> FloatArray:
    """Return by what part of a standard deviation each FRF is believed of each mode, (n_frf, n_modes) [-].

    Where a model does not hold, an FRF may seem to determine a frequency far better than it does: what is left about
    the mode in that FRF counts as its noise. A drift leaves much too, and still shows: over all lines of a peak.
    """
    density = 1.0 / np.abs(frfs.laplace[None, :] - fit.poles[:, None]) ** 2
    left = (weights.full * squared(left_over(frfs, fit))) @ (density / density.sum(axis=1, keepdims=True)).T
    return np.asarray(1.0 / np.sqrt(np.maximum(left, 1.0)))


def _own_shifts(
    pulls: FloatArray, information: FloatArray, within: BoolArray, reach: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return each group's own shifts and their variances, infinite where it does not determine them, (n_groups,
    n_modes).

    Scores are straight in a shift within a half-width of the peak, ``reach`` [-]. A group that does not determine its
    shift to that, at a node or in noise, does not determine it: there a step along the scores may be of any size.
    """
    diagonal = np.einsum("gnn->gn", information)
    seen = (diagonal > 1e-12 * diagonal.max(axis=0, initial=0.0)) & (diagonal > 0) & within
    length = np.where(seen, np.sqrt(np.where(seen, diagonal, 1.0)), np.inf)
    unit = information / (length[:, :, None] * length[:, None, :])
    unit[~seen] = np.eye(len(within))[np.nonzero(~seen)[1]]
    inverse = np.linalg.pinv(unit, rcond=1e-9, hermitian=True)
    variance = np.einsum("gnn->gn", inverse) / length**2
    own = np.einsum("gnm,gm->gn", inverse, pulls / length) / length
    seen &= (variance > 0) & (variance < reach**2)
    return np.where(seen, own, 0.0), np.where(seen, variance, np.inf)


def _common_variance(pulls: FloatArray, information: FloatArray) -> float:
    """Return the variance of the shifts common to all modes [-]."""
    seen = information > 0
    count = int(seen.sum())
    if count < _FEW or not _surely(float(np.sum(pulls[seen] ** 2 / information[seen])), count, _CHANCE).all():
        return 0.0
    return float(
        scatter_beyond_noise((pulls[seen] / information[seen])[:, None], 1.0 / information[seen][:, None])[0]
    )


def _own_variances(
    pulls: FloatArray, information: FloatArray, own: BoolArray, common: float, reach: FloatArray
) -> FloatArray:
    """Return the variances of the shifts that each mode has beside the common ones, (n_modes,) [-].

    Two modes that share a peak in few lines are taken for one, whose frequency is another in every FRF. Where half of
    the groups shift it by more than is believed of a shift, it is none.
    """
    shifts, variance = _own_shifts(pulls, information, own, reach)
    weight = 1.0 / (variance + common)
    mean = np.sum(weight * shifts, axis=1) / np.maximum(weight.sum(axis=1), np.finfo(float).tiny)
    each = scatter_beyond_noise(
        shifts - (mean if own.sum() > 1 and common > 0 else 0.0 * mean)[:, None], variance
    )
    count = np.isfinite(variance).sum(axis=0)
    mean = np.sum(shifts / variance, axis=0) / np.maximum(
        np.sum(1.0 / variance, axis=0), np.finfo(float).tiny
    )
    sure = _surely(np.sum((shifts - mean) ** 2 / variance, axis=0), count, _CHANCE_OF_ONE)
    beyond = np.sum((np.abs(shifts) > LARGEST) & np.isfinite(variance), axis=0)
    return np.where((count < _FEW_OF_ONE) | ~sure | (2 * beyond > count), 0.0, each)


def _surely(chi: FloatArray | float, count: IntArray | int, chance: float) -> BoolArray:
    """Return whether squares over their variances, of ``count`` groups about their mean, are beyond chance."""
    return np.asarray(chi > stats.chi2.isf(chance, np.maximum(count - 1, 1)))


def _of_the_mean(information: FloatArray, variance: FloatArray, common: float) -> FloatArray:
    """Return the variance of a weighted mean over the groups for unit variance, Student's width in it, (n_modes,).

    The scatter between groups is known from as many of them as separate their own shift from noise; where all modes
    share it, together.
    """
    total = information.sum(axis=0)
    share = np.sum((information / np.where(total > 0, total, 1.0)) ** 2, axis=0)
    signal = information.sum(axis=1)[:, None] * common if common > 0 else information * variance
    freedom = np.sum(signal / (1.0 + signal), axis=0) - 1.0
    return np.asarray(np.clip(share, 1.0 / len(information), 1.0) * student_widening(freedom))


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
