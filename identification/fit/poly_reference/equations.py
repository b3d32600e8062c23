"""The normal equations of poles and participations, shapes and all that each FRF has alone projected out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.line_selection import selected_lines
from identification.fit.equations.refine import pole_turns
from identification.fit.poly_reference.blocks import blocks_times, inverses, paired, rotations, times_blocks
from identification.fit.poly_reference.places import Sorted


@dataclass(frozen=True, eq=False)
class Problem:
    """The data and what does not change from step to step.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    weights : Weights
        Reciprocal variances.
    powers : tuple of int
        Powers of s of the residual terms of the receptance [-].
    places : Sorted
        Where each FRF stands.
    free : (n_columns, n_held) bool array
        Which participations are unknown; that of a mode's lead reference is 1.
    """

    frfs: FrfSet
    weights: normal_equations.Weights
    powers: tuple[int, ...]
    places: Sorted
    free: BoolArray


@dataclass(frozen=True, eq=False)
class Step:
    """The problem at one set of poles and participations; the first ``n_held`` poles are held to rank one.

    Parameters
    ----------
    cost : float
        Weighted sum of squared misfits [-].
    long : (n_rows, 2 n_held) array
        (Re, Im) of the shapes, interleaved [m/(N s)].
    residues : (n_frf, n_modes) complex array
        Residues of all poles, signs of directions applied [m/(N s)].
    terms : (n_frf, n_terms) array
        Residual terms of the receptance, signs of directions applied.
    normal, gradient : (n_parameters, n_parameters) and (n_parameters,) arrays
        J^T J and J^T r of (Re, Im) of the poles, then of the participations that are free.
    follow : (n_rows, 2 n_held, n_parameters) array
        Minus the change of the shapes per parameter.
    held : (n_rows, 2 n_held, 2 n_held) array
        Inverse of each row's own normal matrix.
    """

    cost: float
    long: FloatArray
    residues: ComplexArray
    terms: FloatArray
    normal: FloatArray
    gradient: FloatArray
    follow: FloatArray
    held: FloatArray


@dataclass(frozen=True, eq=False)
class Projected:
    """Products of the columns left once those are eliminated whose factor is each FRF's own.

    The columns left are the modes held to rank one, then the slopes by all poles. Eliminated are the free
    modes and the residual terms, whose factors are ``alone`` less ``each`` times those of the columns left.
    """

    gram: FloatArray
    cross: FloatArray
    power: float
    alone: FloatArray
    each: FloatArray
    term_scale: FloatArray


def project(problem: Problem, poles: ComplexArray, n_held: int) -> Projected:
    """Eliminate at given poles, the first ``n_held`` of rank one, what each FRF has alone."""
    few, weights = selected_lines(problem.frfs, poles, problem.weights)
    columns = basis.build(few.axis, poles, problem.powers)
    shared, own = columns.modes[:, : 2 * n_held], columns.modes[:, 2 * n_held :]
    both = np.hstack([shared, columns.slopes, own, columns.terms])
    data = normal_equations.prepared(few.values * problem.places.sign[:, None], weights)
    p, k = normal_equations.form(both, data), 2 * n_held + columns.slopes.shape[1]
    follow = normal_equations.solve(p.gram[:, k:, k:], p.gram[:, k:, :k])
    alone = normal_equations.solve(p.gram[:, k:, k:], p.cross[:, k:, None])[:, :, 0]
    each = np.broadcast_to(follow, (len(p.cross), *follow.shape[1:]))
    gram = p.gram[:, :k, :k] - np.matmul(p.gram[:, :k, k:], follow)
    cross = p.cross[:, :k] - np.einsum("jt,jtk->jk", p.cross[:, k:], each)
    power = weights.level @ (p.power - np.einsum("jt,jt->j", p.cross[:, k:], alone))
    gram = np.broadcast_to(gram, (len(p.cross), k, k))
    return Projected(gram, cross, float(power), alone, each, columns.term_scale)


def evaluate(problem: Problem, poles: ComplexArray, share: ComplexArray) -> Step:
    """Project out shapes, free modes and residual terms.

    Parameters
    ----------
    problem : Problem
        The data.
    poles : (n_modes,) complex array
        Poles, those held to rank one first [rad/s].
    share : (n_columns, n_held) complex array
        Participations [-].
    """
    places, level = problem.places, problem.weights.level
    n_held = share.shape[1]
    m, left = 2 * n_held, project(problem, poles, n_held)
    own = rotations(share)[places.column]
    right = times_blocks(left.gram[:, :, :m], own)
    held, long = _shapes(problem, left, own, right[:, :m])
    here = long[places.row]
    factors, cost = _factors(problem, left, own, here)
    alone = left.alone - np.einsum("jtk,jk->jt", left.each[:, :, :m], factors)
    n_own = 2 * (len(poles) - n_held)
    every = np.hstack([factors, alone[:, :n_own]])
    steps = _local_slopes(every, here, len(poles), n_held)
    across = steps.transpose(0, 2, 1)
    lacking = left.cross - np.einsum("jkm,jm->jk", left.gram[:, :, :m], factors)
    normal, gradient, coupling = _gathered(
        problem,
        np.matmul(across, np.matmul(left.gram, steps)) * level[:, None, None],
        np.einsum("jpk,jk->jp", across, lacking) * level[:, None],
        np.matmul(across, right) * level[:, None, None],
    )
    follow = np.matmul(held, coupling.transpose(0, 2, 1))
    normal = normal - np.einsum("ipm,imq->pq", coupling, follow, optimize=True)
    return Step(
        cost=cost,
        long=long,
        residues=paired(every),
        terms=alone[:, n_own:] * left.term_scale,
        normal=0.5 * (normal + normal.T),
        gradient=gradient,
        follow=follow,
        held=held,
    )


def _shapes(
    problem: Problem, left: Projected, own: FloatArray, right: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the inverse of each row's normal matrix and its best shape components."""
    level, m = problem.weights.level, right.shape[-1]
    normal = summed(problem.places, level[:, None, None] * blocks_times(own, right))
    target = summed(problem.places, level[:, None] * blocks_times(own, left.cross[:, :m, None])[:, :, 0])
    held = inverses(normal)
    return held, np.einsum("imk,ik->im", held, target)


def _factors(
    problem: Problem, left: Projected, own: FloatArray, here: FloatArray
) -> tuple[FloatArray, float]:
    """Return what each FRF's columns held to rank one are multiplied by, (n_frf, 2 n_held), and the misfit."""
    n_held = own.shape[1]
    factors = np.einsum("jnab,jnb->jna", own, here.reshape(-1, n_held, 2)).reshape(-1, 2 * n_held)
    each = np.einsum("jk,jk->j", left.cross[:, : 2 * n_held], factors)
    return factors, max(left.power - float(each @ problem.weights.level), 0.0)


def summed(places: Sorted, values: FloatArray) -> FloatArray:
    """Return sums over the FRFs of each row, (n_rows, ...): within a column no row occurs twice."""
    total = np.zeros((places.shape[0], *values.shape[1:]))
    for column in range(places.shape[1]):
        mine = np.flatnonzero(places.column == column)
        total[places.row[mine]] += values[mine]
    return total


def _local_slopes(factors: FloatArray, long: FloatArray, n_modes: int, n_held: int) -> FloatArray:
    """Return what steps of the poles and of the FRF's own participations put on the columns left.

    Shape (n_frf, 2 n_held + 2 n_modes, 2 n_modes + 2 n_held).
    """
    m, q = 2 * n_held, 2 * n_modes
    steps = np.zeros((len(factors), m + q, q + m))
    by_pole, by_share = pole_turns(factors, n_modes), rotations(paired(long))
    poles, modes = 2 * np.arange(n_modes), 2 * np.arange(n_held)
    for a in range(2):
        for b in range(2):
            steps[:, m + poles + a, poles + b] = by_pole[:, :, a, b]
            steps[:, modes + a, q + modes + b] = by_share[:, :, a, b]
    return steps


def _gathered(
    problem: Problem, local: FloatArray, slope: FloatArray, lean: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sum what each FRF says of the poles and of its own reference into all parameters."""
    places, m = problem.places, lean.shape[-1]
    q = local.shape[-1] - m
    n_rows, n_columns = places.shape
    total = q + m * n_columns
    normal, gradient = np.zeros((total, total)), np.zeros(total)
    coupling = np.zeros((n_rows, total, m))
    normal[:q, :q], gradient[:q] = local[:, :q, :q].sum(axis=0), slope[:, :q].sum(axis=0)
    coupling[:, :q] = summed(places, lean[:, :q])
    for column in range(n_columns):
        mine, part = places.column == column, slice(q + m * column, q + m * (column + 1))
        block = local[mine].sum(axis=0)
        normal[:q, part], normal[part, :q] = block[:q, q:], block[q:, :q]
        normal[part, part], gradient[part] = block[q:, q:], slope[mine, q:].sum(axis=0)
        coupling[places.row[mine], part] = lean[mine, q:]
    keep = np.concatenate([np.ones(q, bool), np.repeat(problem.free, 2, axis=1).ravel()])
    return normal[np.ix_(keep, keep)], gradient[keep], coupling[:, keep]


def residue_gain(problem: Problem, step: Step, share: ComplexArray) -> FloatArray:
    """Return the change of Im R_ij per parameter, shapes following, shape (n_frf, n_held, n_parameters)."""
    places, n_held = problem.places, share.shape[1]
    q, m = 2 * step.residues.shape[1], 2 * n_held
    own = rotations(share)[places.column]
    moved = -step.follow[places.row].reshape(len(own), n_held, 2, -1)
    gain = np.einsum("jnb,jnbp->jnp", own[:, :, 1], moved)
    by_share = rotations(paired(step.long))[places.row]
    wide = np.zeros((len(own), n_held, m * places.shape[1]))
    rows, modes = np.arange(len(own))[:, None], np.arange(n_held)[None, :]
    for part in range(2):
        wide[rows, modes, m * places.column[:, None] + 2 * modes + part] = by_share[:, :, 1, part]
    gain[:, :, q:] += wide[:, :, np.repeat(problem.free, 2, axis=1).ravel()]
    return np.asarray(gain)
