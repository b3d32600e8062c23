"""Noise that all outputs of a hit have in common, and the evidence for a mode without it.

Noise of the force multiplies all responses of a hit by the same 1 + e(f): it looks like a mode in all outputs at
once, and no single output shows it. With h the FRFs of one hit point and r what a model leaves of them, the noise
has the covariance A + b h h^H, A diagonal; b follows from how much more power the residual has along h
than independent noise of the same size would have. What the common part explains is then taken out (the
conditional mean of e given r), and what is left supports a mode or does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, row_blocks, squared
from acquisition.frfs.frf import FrfSet
from identification.arrangement import unsigned
from identification.fit.equations.background import gains
from identification.fit.equations.basis import Axis
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.pruning import strength, threshold
from identification.fit.equations.refine import Fit
from identification.fit.equations.residues import Residues, synthesise
from identification.fit.noise import leakage
from identification.fit.noise.levels import local_mean, window_length
from identification.fit.noise.weights import decay_over_record, left_over
from identification.fit.noise.window_shaped import inflation

_ROUNDS = 6
_PEAK = 6.0
"""Power over the expected one by which a line counts at the most [-]. The peak of a mode that the model lacks, a few
lines wide, is no noise; of noise 1 line in 400 has more. Each round may raise b as many times, so that what all lines
have is reached; twice as much takes such peaks for common noise, and the modes are missed."""
_OWN = 0.05
"""Least part of a value's variance that is taken to be its own [-]. It keeps the conditional mean finite where force
noise is all there is; twice as much changes the common part by as many per cent."""
_SURE = 3.0
"""Standard deviations by which the power along h must exceed that of independent noise to count. Without the question
half of all clean tests would have a little of it; twice as much would miss what makes modes of noise."""
_DEPENDENT = (
    1.94  # what squares of such differences of white noise have more of variance, being tied line to line
)
_DIFFERENCE = np.array([1.0, -2.0, 1.0]) / np.sqrt(6.0)


@dataclass(frozen=True, eq=False)
class CommonNoise:
    """Relative noise common to the FRFs of each hit point.

    Parameters
    ----------
    groups : tuple of int arrays
        Rows of the FRFs that share their hits, two or more in each.
    variance : tuple of (n_lines,) arrays
        Variance b of the common factor, one array per group [-].
    own : (n_frf, n_lines) array
        Variance of what is not common [unit of the FRFs squared].
    """

    groups: tuple[IntArray, ...]
    variance: tuple[FloatArray, ...]
    own: FloatArray

    def removed(self, way: ComplexArray, residual: ComplexArray) -> ComplexArray:
        """Return a residual without what the common noise explains of it, shape (n_frf, n_lines).

        Parameters
        ----------
        way : (n_frf, n_lines) complex array
            What the common factor multiplies, of :func:`direction` [unit of the FRFs].
        residual : (n_frf, n_lines) complex array
            Data minus model [unit of the FRFs].
        """
        rest = np.array(residual)
        for rows, variance in zip(self.groups, self.variance, strict=True):
            if not variance.any():
                continue
            h, own = way[rows], self.own[rows]
            along = np.sum(h.conj() * residual[rows] / own, axis=0)
            power = np.sum(np.abs(h) ** 2 / own, axis=0)
            rest[rows] -= h * (variance * along / (1.0 + variance * power))
        return rest


def hit_groups(frfs: FrfSet) -> tuple[IntArray, ...]:
    """Return the rows of FRFs that share their hits: as the scatter of the hits has it, else by reference.

    Averages over windowed blocks may all be of one force, whatever their references: their errors show it.
    """
    if leakage.follows(frfs):
        rows: tuple[IntArray, ...] = (np.arange(len(frfs.values)),)
    elif frfs.scatter is not None:
        rows = frfs.scatter.hit_groups
    else:
        names = [unsigned(dof) for dof in frfs.references]
        rows = tuple(np.flatnonzero([n == name for n in names]) for name in dict.fromkeys(names))
    return tuple(np.asarray(r) for r in rows if len(r) > 1)


def direction(frfs: FrfSet, poles: ComplexArray, linear: Residues) -> ComplexArray:
    """Return what the common factor of each line multiplies, (n_frf, n_lines) [unit of the FRFs].

    The FRFs, as noise of the force does; in averages over windowed blocks what a block cuts off.
    """
    leaked = leakage.leaked(frfs, poles, linear.residues)
    return synthesise(Axis.of(frfs), poles, linear) if leaked is None else leaked


def common_noise(
    frfs: FrfSet, way: ComplexArray, residual: ComplexArray, variance: FloatArray
) -> CommonNoise:
    """Estimate the common noise from what a fit leaves.

    Differences from line to line are used, which do not mind what the model still lacks; b may vary with
    frequency as slowly as a force spectrum does. Averages over windowed blocks have one b for all lines.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    way, residual : (n_frf, n_lines) complex arrays
        What the noise multiplies, and data minus a fit [unit of the FRFs].
    variance : (n_frf, n_lines) array
        Noise variance of every value, common part included [unit of the FRFs squared].
    """
    groups = hit_groups(frfs)
    own, each = variance, []
    for rows in groups:
        if leakage.follows(frfs):
            b = np.full(way.shape[1], leakage.shared(way, residual, variance))
        else:
            b = _factor_variance(way, residual, variance, rows)
        each.append(b)
        if b.any():
            own = np.array(own) if own is variance else own
            own[rows] = np.maximum(variance[rows] - b * squared(way[rows]), _OWN * variance[rows])
    return CommonNoise(groups, tuple(each), own)


def _factor_variance(
    model: ComplexArray, residual: ComplexArray, variance: FloatArray, rows: IntArray
) -> FloatArray:
    """Return b at every line: with unit vector u along h, E |u^H r|^2 = 1 + b m in units of the noise."""
    n_lines = model.shape[1]
    power, fourth, along = np.zeros(n_lines), np.zeros(n_lines), np.zeros(n_lines, np.complex128)
    for block in row_blocks((len(rows), n_lines)):
        h, v = model[rows[block]], variance[rows[block]]
        each = squared(h) / v
        power += each.sum(axis=0)
        fourth += np.sum(each**2, axis=0)
        along += np.sum(h.conj() * residual[rows[block]] / v, axis=0)
    power = np.maximum(power, np.finfo(float).tiny)
    along /= np.sqrt(power)
    slope = np.maximum(power - fourth / power, 0.0)
    if n_lines < 3 * len(_DIFFERENCE):
        return np.zeros(n_lines)
    rough = np.abs(ndimage.convolve1d(along, _DIFFERENCE, mode="reflect")) ** 2
    slope = ndimage.convolve1d(slope, _DIFFERENCE**2, mode="reflect")
    b = np.zeros(n_lines)
    if np.sum(slope * (np.minimum(rough, _PEAK) - 1.0)) < _SURE * np.sqrt(_DEPENDENT * np.sum(slope**2)):
        return b
    window = window_length(n_lines)
    for _ in range(_ROUNDS):
        expected = 1.0 + b * slope
        weight = slope / expected**2
        excess = np.minimum(rough, _PEAK * expected) - 1.0
        mean = local_mean(np.stack([weight * excess, weight * slope]), window)
        b = np.maximum(mean[0], 0.0) / np.maximum(mean[1], np.finfo(float).tiny)
    return np.asarray(b)


def beyond_common_noise(frfs: FrfSet, fit: Fit, weights: Weights) -> BoolArray:
    """Return which modes of a fit stand out of what noise common to all outputs can make, shape (n_modes,).

    Without the mode, what the common noise explains of the rest is taken out; the mode must still explain more
    than noise can. Modes so strong that no common noise reaches them are not asked, and none where there is none.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    fit : Fit
        A fit to them.
    weights : Weights
        Reciprocal variances it was made with.
    """
    stands = np.ones(len(fit.poles), dtype=np.bool_)
    groups = hit_groups(frfs)
    if not groups or len(fit.poles) < 2:
        return stands
    limit = threshold(*frfs.values.shape)
    held = inflation(weights.fade, decay_over_record(frfs, fit.poles))[0]
    doubtful = strength(fit) < limit * held * max(len(g) for g in groups)
    residual = left_over(frfs, fit)
    leaked = leakage.leaked(frfs, fit.poles, fit.linear.residues)
    way = frfs.values - residual if leaked is None else leaked
    noise = common_noise(frfs, way, residual, 1.0 / weights.full)
    if not any(variance.any() for variance in noise.variance):
        return stands
    for mode in np.flatnonzero(doubtful):
        rest = np.delete(np.arange(len(fit.poles)), mode)
        linear = replace(fit.linear, residues=fit.linear.residues[:, rest])
        model, way = (
            synthesise(Axis.of(frfs), fit.poles[rest], linear),
            direction(frfs, fit.poles[rest], linear),
        )
        bare = replace(frfs, values=model + noise.removed(way, frfs.values - model))
        gain = 2.0 * gains(bare, fit.poles[rest], fit.linear.powers, weights, fit.poles[[mode]])[0]
        stands[mode] = gain > limit * held[mode]
    return stands


def without_common_noise(frfs: FrfSet, fit: Fit, weights: Weights) -> ComplexArray:
    """Return what a fit leaves less what noise common to all outputs explains of it, shape (n_frf, n_lines).

    Parameters as for :func:`beyond_common_noise`.
    """
    residual, way = left_over(frfs, fit), direction(frfs, fit.poles, fit.linear)
    return common_noise(frfs, way, residual, 1.0 / weights.full).removed(way, residual)
