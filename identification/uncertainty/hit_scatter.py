"""From the scatter of the hits to the scatter of poles and constants, whatever ties lines and FRFs together.

A hit's share in the error of the FRFs moves the fit by J^+ W s, so the sum of squares over the hits is the
covariance of the fit: the sandwich estimator (White, Econometrica 48 (1980) 817-838; for groups of related
data Liang and Zeger, Biometrika 73 (1986) 13-22). It includes hits that missed their point, responses that
share a force, and of lines tied together by a window. What it does not include it cannot have seen: there are as
many terms as hits. So it is used for the ratio to the covariance the weights give, and few hits are shrunk to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.scatter import variance_of_groups
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.projection import pole_turns
from identification.fit.equations.pruning import inverse_information
from identification.fit.equations.refine import Fit
from identification.fit.noise.disagreement import student_widening
from identification.fit.poly_reference import sorted_frfs

_PRIOR_FREEDOM = 10.0
_UNSEEN, _LARGEST = 1e-100, 1e8
# what raises the noise of a pole raises that of all poles; a hit that misses its point, that point's constants
_ALIKE_POLES, _ALIKE_CONSTANTS = 40.0, 4.0


@dataclass(frozen=True, eq=False)
class NoiseFactors:
    """By what factor true variances exceed those of independent noise of the weights' size.

    Parameters
    ----------
    poles : (n_modes,) array
        For each pole [-].
    constants : (n_frf, n_modes) array
        For each modal constant [-].
    shapes : (n_modes,) array
        Further, for a component of the shape that constants of several references give: their errors are not
        independent if they come from the same hits [-].
    held : (n_frf, n_modes) array
        For each modal constant were the poles known: what is its own and no other constant shares. Not raised
        for the few degrees of freedom behind it: it weighs data by the hundred [-].
    by_hits : tuple of _Sums
        What each hit moves, by groups of FRFs that were averaged over the same hits; empty where no hits are known.
    """

    poles: FloatArray
    constants: FloatArray
    shapes: FloatArray
    held: FloatArray
    by_hits: tuple[_Sums, ...] = ()


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums over the hits of one group, (Re, Im) of poles interleaved.

    Parameters
    ----------
    steps : (n_hits, 2 n_modes) array
        What each hit moves the poles by [rad/s].
    constants : (n_rows, n_modes) array
        Sum of squares of what it moves Im of the residues by, less that by the poles alone.
    held : (n_rows, n_modes) array
        The same with the poles held.
    alone : (n_hits, n_rows, n_modes) array
        What each hit moves Im of the residues by with the poles held [as the residues].
    rows : (n_rows,) int array
        Which FRFs.
    joint, disagreement : (n_modes,) arrays
        Sums of squares of what it moves a shape's components by: as it is, and as if the FRFs were moved
        independently.
    """

    steps: FloatArray
    constants: FloatArray
    held: FloatArray
    alone: FloatArray
    rows: IntArray
    joint: FloatArray
    disagreement: FloatArray


def factors(
    frfs: FrfSet, fit: Fit, weights: normal_equations.Weights, modes: BoolArray, prior: NoiseFactors
) -> NoiseFactors | None:
    """Return the noise factors from the hits, or None where no scatter of hits came with the FRFs.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    fit : Fit
        The fit.
    weights : Weights
        Reciprocal variances it was made with.
    modes : (n_modes,) bool array
        Which poles are modes; background poles do not count where factors are pooled.
    prior : NoiseFactors
        What is taken where hits are few: it counts as ten degrees of freedom.
    """
    if frfs.scatter is None:
        return None
    n, places = len(fit.poles), sorted_frfs(frfs)
    point = np.arange(len(frfs.values)) if places is None else places.row
    columns = basis.build(basis.Axis.of(frfs), fit.poles, fit.linear.powers).columns
    real, imaginary = np.ascontiguousarray(columns.real), np.ascontiguousarray(columns.imag)
    plain = inverse_information(2.0 * fit.equations.step.normal)
    groups = [
        _moved(
            fit, weights, (real, imaginary), 2.0 * plain, np.asarray(g.rows), np.asarray(g.deviations), point
        )
        for g in frfs.scatter.groups
    ]
    steps = [g.steps for g in groups]
    spread = sum((s.T @ s for s in steps), np.zeros((2 * n, 2 * n)))
    ratio = _ratio(np.diag(spread), np.diag(plain))
    freedom = np.where(modes, 2 * _freedom(steps, n), 0.0)
    of_poles = prior.poles * _shrunk(ratio.reshape(n, 2).mean(axis=1) / prior.poles, freedom, _ALIKE_POLES)
    of_constants = _of_constants(fit, groups, spread, plain, prior.constants)
    return NoiseFactors(
        of_poles, of_constants, _of_shapes(groups), _of_held(fit, groups, prior.held), tuple(groups)
    )


def _of_shapes(groups: list[_Sums]) -> FloatArray:
    """Return the variance of shape components over that of independent constants, 1 or more."""
    joint, disagreement = sum(g.joint for g in groups), sum(g.disagreement for g in groups)
    return np.asarray(np.maximum(_ratio(np.asarray(joint), np.asarray(disagreement)), 1.0))


def _moved(
    fit: Fit,
    weights: normal_equations.Weights,
    columns: tuple[FloatArray, FloatArray],
    inverse: FloatArray,
    rows: IntArray,
    deviations: ComplexArray,
    point: IntArray,
) -> _Sums:
    """Return what the hits of one group move."""
    n, k = len(fit.poles), fit.equations.step.solution.shape[1]
    each = rows if len(weights.lines) > 1 else np.zeros(1, np.int64)
    moved = deviations * weights.lines[each]
    cross = moved.real @ columns[0] + moved.imag @ columns[1]  # (n_hits, n_rows, k + 2 n)
    gram, follow = fit.equations.products.gram[each, :k, :k], fit.equations.follow[each]
    by_row, hits = cross.transpose(1, 2, 0), len(cross)
    alone = normal_equations.solve(gram, by_row[:, :k]).transpose(2, 0, 1)
    left = (by_row[:, k:] - np.matmul(follow.transpose(0, 2, 1), by_row[:, :k])).transpose(2, 0, 1)
    residues = fit.linear.residues[rows]
    turns = pole_turns(np.stack([residues.real, residues.imag], axis=2).reshape(len(rows), -1), n)
    gradient = np.einsum(
        "j,hjni,jnia->hna", weights.level[rows], left.reshape(hits, len(rows), n, 2), turns, optimize=True
    )
    steps = gradient.reshape(hits, 2 * n) @ inverse
    gain = fit.pole_gain[rows]
    own, by_poles = alone[:, :, 1 : 2 * n : 2], np.einsum("jnp,hp->hjn", gain, steps)
    joint, disagreement = _shared(own + by_poles, residues.imag * weights.level[rows, None], point[rows])
    both = np.sum(own**2 + 2.0 * own * by_poles, axis=0)
    return _Sums(steps, both, np.sum(own**2, axis=0), own, rows, joint, disagreement)


def _shared(moved: FloatArray, share: FloatArray, point: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return sums of squares of weighted means over the FRFs of a point, and as if these were independent.

    Parameters
    ----------
    moved : (n_hits, n_rows, n_modes) array
        What each hit moves the constants by.
    share : (n_rows, n_modes) array
        Weight of each constant in its point's component.
    point : (n_rows,) int array
        Which point each FRF is of.
    """
    weighted = moved * share
    means = np.zeros((int(point.max()) + 1, len(moved), moved.shape[2]))
    np.add.at(means, point, weighted.transpose(1, 0, 2))
    return np.sum(means**2, axis=(0, 1)), np.sum(weighted**2, axis=(0, 1))


def _freedom(steps: list[FloatArray], n_modes: int) -> FloatArray:
    """Return the degrees of freedom behind each pole's variance, shape (n_modes,) [-]."""
    _, freedom = variance_of_groups(steps)
    return np.asarray(np.where(np.isfinite(freedom), freedom, 0.0).reshape(n_modes, 2).mean(axis=1))


def _ratio(found: FloatArray, expected: FloatArray) -> FloatArray:
    """Return found over expected variances; 1 for what the data say nothing of, and never beyond reason."""
    known = expected > _UNSEEN * expected.max(initial=0.0)
    ratio = np.divide(found, expected, out=np.ones_like(found), where=known)
    return np.asarray(np.minimum(ratio, _LARGEST))


def _shrunk(ratio: FloatArray, freedom: FloatArray, alike: float, *, wide: bool = True) -> FloatArray:
    """Shrink each ratio of true to expected variance to that of all, and that to one.

    ``alike`` is how many degrees of freedom the ratio of all counts as, in each [-]. A variance from few
    degrees of freedom makes errors Student's: where ``wide``, it is raised so that 1.96 standard deviations
    still are a 95 % interval.
    """
    total = float(freedom.sum())
    pooled = (float(np.sum(freedom * ratio)) + _PRIOR_FREEDOM) / (total + _PRIOR_FREEDOM)
    borrowed = min(alike, total + _PRIOR_FREEDOM)
    known = freedom + borrowed
    wider = student_widening(known) if wide else 1.0
    return np.asarray(wider * (freedom * ratio + borrowed * pooled) / known)


def _of_constants(
    fit: Fit, groups: list[_Sums], spread: FloatArray, plain: FloatArray, prior: FloatArray
) -> FloatArray:
    """Return the factor of each constant, those of a mode being shrunk to one another."""
    gain = fit.pole_gain
    found = np.einsum("jnp,pq,jnq->jn", gain, spread, gain, optimize=True)
    expected = fit.residue_inverse[:, 1::2] + np.einsum("jnp,pq,jnq->jn", gain, plain, gain, optimize=True)
    freedom = np.zeros(len(found))
    for group in groups:
        np.add.at(found, group.rows, group.constants)
        np.add.at(freedom, group.rows, len(group.steps) - 1.0)
    ratio = _ratio(np.maximum(found, 0.0), expected * prior)
    modes = [_shrunk(column, freedom, _ALIKE_CONSTANTS) for column in ratio.T]
    return np.asarray(prior * np.stack(modes, axis=1))


def _of_held(fit: Fit, groups: list[_Sums], prior: FloatArray) -> FloatArray:
    """Return the same for constants with the poles held."""
    expected = fit.residue_inverse[:, 1::2]
    found, freedom = np.zeros(expected.shape), np.zeros(len(expected))
    for group in groups:
        np.add.at(found, group.rows, group.held)
        np.add.at(freedom, group.rows, len(group.steps) - 1.0)
    ratio = _ratio(found, expected * prior)
    modes = [_shrunk(column, freedom, _ALIKE_CONSTANTS, wide=False) for column in ratio.T]
    return np.asarray(prior * np.stack(modes, axis=1))
