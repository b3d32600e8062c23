"""The normal equations of poles and participations, shapes and all that each FRF has alone projected out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, row_blocks
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.line_selection import selected_lines
from identification.fit.equations.projection import carried, pole_turns
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
    Of ``gram`` and ``each`` there is one for all FRFs where their lines weigh alike.
    """

    gram: FloatArray
    cross: FloatArray
    power: float
    alone: FloatArray
    each: FloatArray
    term_scale: FloatArray

    def alike(self, places: Sorted, block: slice = slice(None)) -> Iterator[tuple[FloatArray, IntArray, int]]:
        """Yield sets of FRFs of one column that share their products: these, the FRFs and the column.

        Only FRFs of a block of rows count.
        """
        first, last, _ = block.indices(places.shape[0])
        inside = (places.row >= first) & (places.row < last)
        if len(self.gram) == 1:
            for column in range(places.shape[1]):
                yield self.gram[0], np.flatnonzero(inside & (places.column == column)), column
        else:
            for number in np.flatnonzero(inside):
                yield self.gram[number], np.array([number]), int(places.column[number])


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
    gram = p.gram[:, :k, :k] - np.matmul(p.gram[:, :k, k:], follow)
    cross = p.cross[:, :k] - carried(p.cross[:, k:], follow)
    power = weights.level @ (p.power - np.einsum("jt,jt->j", p.cross[:, k:], alone))
    return Projected(gram, cross, float(power), alone, follow, columns.term_scale)


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
    n_held = share.shape[1]
    m, left, own = 2 * n_held, project(problem, poles, n_held), rotations(share)
    held, long = _shapes(problem, left, own)
    here = long[problem.places.row]
    factors, cost = _factors(problem, left, own, here)
    alone = left.alone - carried(factors, left.each.transpose(0, 2, 1)[:, :m])
    n_own = 2 * (len(poles) - n_held)
    every = np.hstack([factors, alone[:, :n_own]])
    turns = np.concatenate([rotations(paired(here)), pole_turns(every, len(poles))], axis=1)
    normal, gradient, follow = _gathered(problem, left, own, factors, turns, held)
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


def _shapes(problem: Problem, left: Projected, own: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the inverse of each row's normal matrix and its best shape components."""
    places, m = problem.places, 2 * own.shape[1]
    held, long = np.empty((places.shape[0], m, m)), np.empty((places.shape[0], m))
    for block in row_blocks((places.shape[0], m**2)):
        normal, target = np.zeros(held[block].shape), np.zeros(long[block].shape)
        for gram, mine, column in left.alike(places, block):
            rows, level = places.row[mine] - block.start, problem.weights.level[mine]
            inner = blocks_times(own[column], times_blocks(gram[:m, :m], own[column]))
            normal[rows] += level[:, None, None] * inner
            target[rows] += level[:, None] * times_blocks(left.cross[mine, :m], own[column])
        held[block] = inverses(normal)
        long[block] = np.matmul(held[block], target[:, :, None])[:, :, 0]
    return held, long


def _factors(
    problem: Problem, left: Projected, own: FloatArray, here: FloatArray
) -> tuple[FloatArray, float]:
    """Return what each FRF's columns held to rank one are multiplied by, (n_frf, 2 n_held), and the misfit."""
    each = own[problem.places.column].transpose(0, 1, 3, 2)
    factors = times_blocks(here[:, None, :], each)[:, 0]
    gain = np.einsum("jk,jk->j", left.cross[:, : factors.shape[1]], factors)
    return factors, max(left.power - float(gain @ problem.weights.level), 0.0)


def _gathered(
    problem: Problem,
    left: Projected,
    own: FloatArray,
    factors: FloatArray,
    turns: FloatArray,
    held: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sum the information of each FRF on the poles and on its own reference into all parameters, shapes eliminated.

    Parameters
    ----------
    problem, left : Problem and Projected
        The data, and their normal equations at given poles.
    own : (n_columns, n_held, 2, 2) array
        Participations [-].
    factors : (n_frf, 2 n_held) array
        What the columns held to rank one are multiplied by.
    turns : (n_frf, n_held + n_modes, 2, 2) array
        What steps of the FRF's own participations and of the poles put on the columns left.
    held : (n_rows, 2 n_held, 2 n_held) array
        Inverse of each row's own normal matrix.

    Returns
    -------
    normal, gradient, follow : (n_parameters, n_parameters), (n_parameters,) and (n_rows, 2 n_held, n_parameters)
    """
    places, m = problem.places, factors.shape[1]
    q = left.cross.shape[1] - m
    keep = np.concatenate([np.ones(q, bool), np.repeat(problem.free, 2, axis=1).ravel()])
    kept, total = np.cumsum(keep) - 1, len(keep)
    normal, gradient = np.zeros((total, total)), np.zeros(total)
    eliminated = np.zeros((int(keep.sum()), int(keep.sum())))
    follow = np.empty((places.shape[0], m, len(eliminated)))
    for block in row_blocks((places.shape[0], m * len(eliminated))):
        coupling = np.zeros((len(held[block]), len(eliminated), m))
        for gram, mine, column in left.alike(places, block):
            share = q + m * column + np.arange(m)
            at, free = np.concatenate([share, np.arange(q)]), np.flatnonzero(keep[share])
            weighted = problem.weights.level[mine, None, None, None] * turns[mine]
            normal[np.ix_(at, at)] += _turned(gram, turns[mine], weighted)
            lacking = left.cross[mine] - factors[mine] @ gram[:m]
            gradient[at] += times_blocks(lacking[:, None], weighted)[:, 0].sum(axis=0)
            lean = blocks_times(weighted, times_blocks(gram[:, :m], own[column])[None])
            rows = places.row[mine] - block.start
            coupling[rows, :q] += lean[:, m:]
            coupling[rows[:, None], kept[share[free]]] = lean[:, free]
        follow[block] = np.matmul(held[block], coupling.transpose(0, 2, 1))
        eliminated += np.tensordot(coupling, follow[block], axes=((0, 2), (0, 1)))
    return normal[np.ix_(keep, keep)] - eliminated, gradient[keep], follow


def _turned(gram: FloatArray, turns: FloatArray, weighted: FloatArray) -> FloatArray:
    """Return sum_j T_j^T G W_j over FRFs that share G, T_j and W_j being block diagonal, shape as ``gram``."""
    if len(turns) == 1:
        return blocks_times(turns[0], times_blocks(gram, weighted[0]))
    n, total = turns.shape[1], np.zeros(gram.shape)
    pairs = turns.reshape(len(turns), -1).T @ weighted.reshape(len(turns), -1)
    pairs, blocks = pairs.reshape(n, 2, 2, n, 2, 2), total.reshape(n, 2, n, 2)
    for i in range(2):
        for k in range(2):
            blocks += gram[i::2, None, k::2, None] * pairs[:, i, :, :, k, :]
    return total


def residue_gain(problem: Problem, step: Step, share: ComplexArray, column: int) -> FloatArray:
    """Return the change of Im R_ij per parameter, shapes following, for the FRFs of a column, in their order.

    Shape (n, n_held, n_parameters).
    """
    places, n_held = problem.places, share.shape[1]
    rows, own = places.row[places.column == column], rotations(share[column])[:, 1]
    moved = step.follow[rows].reshape(len(rows), n_held, 2, -1)
    gain = -(own[:, 0, None] * moved[:, :, 0] + own[:, 1, None] * moved[:, :, 1])
    modes = np.flatnonzero(problem.free[column])
    at = 2 * (step.residues.shape[1] + np.count_nonzero(problem.free[:column]) + np.arange(len(modes)))
    by_share = rotations(paired(step.long))[rows[:, None], modes, 1]
    for part in range(2):
        gain[:, modes, at + part] += by_share[:, :, part]
    return np.asarray(gain)
