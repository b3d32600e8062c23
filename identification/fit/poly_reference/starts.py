"""Where the search for participations starts."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.fit.equations import normal_equations
from identification.fit.poly_reference.equations import Problem, project
from identification.fit.poly_reference.pairs import PairEquations
from identification.fit.poly_reference.places import Sorted

_CLOSE = 3.0  # poles nearer than this many half-power half-widths share their residues at will
_SMALL = 1e-3
_ANGLES = np.pi * np.arange(8) / 8


def first_participations(
    residues: ComplexArray, weights: normal_equations.Weights, places: Sorted
) -> tuple[IntArray, ComplexArray]:
    """Return the lead column of each mode and participations from the best rank-one residues."""
    n_modes = residues.shape[1]
    table = np.zeros((*places.shape, n_modes), complex)
    table[places.row, places.column] = residues * places.sign[:, None]
    weight = np.zeros(places.shape)
    weight[places.row, places.column] = weights.level
    lead = np.einsum("ij,ijm->jm", weight, np.abs(table) ** 2).argmax(axis=0)
    modes = np.arange(n_modes)
    share = np.zeros((places.shape[1], n_modes), complex)
    share[lead, modes] = 1.0
    tiny = np.finfo(float).tiny
    for _ in range(20):
        below = np.maximum(np.einsum("ij,jm->im", weight, np.abs(share) ** 2), tiny)
        long = np.einsum("ij,ijm,jm->im", weight, table, share.conj()) / below
        above = np.maximum(np.einsum("ij,im->jm", weight, np.abs(long) ** 2), tiny)
        share = np.einsum("ij,ijm,im->jm", weight, table, long.conj()) / above
        share = share / share[lead, modes]
    return lead, share


def untangled(problem: Problem, poles: ComplexArray, share: ComplexArray) -> ComplexArray:
    """Return better participations for close modes, shape (n_columns, n_held) [-].

    Free residues of two close modes each hold a part of the other, and a search that starts from them may end
    in a minimum of its own. Both participations lie in the plane that the two residues span together; pairs of
    directions in it are tried.

    Parameters
    ----------
    problem : Problem
        The data.
    poles : (n_modes,) complex array
        Poles, those held to rank one first [rad/s].
    share : (n_columns, n_held) complex array
        Participations, 1 at the lead references [-].
    """
    near = [
        (a, b)
        for a, b in combinations(range(share.shape[1]), 2)
        if abs(poles[a] - poles[b]) <= _CLOSE * max(-poles[a].real, -poles[b].real)
    ]
    if not near:
        return share
    left, best = project(problem, poles, share.shape[1]), share.copy()
    for a, b in near:
        trials = _trials(best[:, [a, b]], ~problem.free[:, [a, b]])
        found = PairEquations.of(problem, left, best, (a, b)).misfits(trials)
        best[:, [a, b]] = trials[int(found.argmin())]
    return best


def _trials(pair: ComplexArray, lead: BoolArray) -> ComplexArray:
    """Return participations of two modes to try, as they are first, 1 at the leads, (n_trials, n_columns, 2)."""
    modes = np.arange(2)
    tried = np.stack([pair.real, *(np.stack(both, axis=1) for both in _directions(pair))])
    scale = tried[:, lead.argmax(axis=0), modes][:, None, :]
    small = np.abs(scale) <= _SMALL
    trials = np.where(small, pair, tried / np.where(small, 1.0, scale))
    trials[0] = pair
    return np.asarray(trials, dtype=np.complex128)


def _directions(pair: ComplexArray) -> list[tuple[FloatArray, FloatArray]]:
    """Return pairs of directions in the plane of two participations, the modes being nearly real."""
    plane = np.linalg.svd(pair.real, full_matrices=False)[0]
    turned = [plane[:, 0] * np.cos(angle) + plane[:, 1] * np.sin(angle) for angle in _ANGLES]
    return [(x, y) for i, x in enumerate(turned) for j, y in enumerate(turned) if i != j]
