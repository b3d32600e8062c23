"""The misfit for many trial participations of two modes, all that they do not change eliminated once.

Only the columns of two modes depend on a trial. With the shapes of the other modes projected out, each row of the
matrix of FRFs keeps normal equations of 4 unknowns for each reference, whatever the number of modes; a trial then
solves for 4 unknowns a row.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from identification.fit.poly_reference.blocks import blocks_times, inverses, rotations, times_blocks
from identification.fit.poly_reference.equations import Problem, Projected


@dataclass(frozen=True, eq=False)
class PairEquations:
    """Normal equations of the factors of two modes in each FRF, the shapes of all other modes eliminated.

    Parameters
    ----------
    normal : (n_rows, 4 n_columns, 4 n_columns) array
        J^T J of the (Re, Im) factors of both modes, by column.
    target : (n_rows, 4 n_columns) array
        J^T r of the same.
    rest : float
        Misfit without the two modes [-].
    """

    normal: FloatArray
    target: FloatArray
    rest: float

    @classmethod
    def of(
        cls, problem: Problem, left: Projected, share: ComplexArray, pair: tuple[int, int]
    ) -> PairEquations:
        """Eliminate the shapes of all modes but two, participations given.

        Parameters
        ----------
        problem, left : Problem and Projected
            The data, and their normal equations at given poles.
        share : (n_columns, n_held) complex array
            Participations; those of the two modes do not count [-].
        pair : tuple of int
            The two modes.
        """
        places = problem.places
        both = (2 * np.array(pair)[:, None] + np.arange(2)).ravel()
        others = np.setdiff1d(np.arange(share.shape[1]), pair)
        rest = (2 * others[:, None] + np.arange(2)).ravel()
        turns = rotations(share[:, others])
        n_rows, n_columns = places.shape
        inner, aim = np.zeros((n_rows, len(rest), len(rest))), np.zeros((n_rows, len(rest)))
        shared = np.zeros((n_rows, len(rest), n_columns, 4))
        normal, target = np.zeros((n_rows, n_columns, 4, n_columns, 4)), np.zeros((n_rows, n_columns, 4))
        for gram, mine, column in left.alike(places):
            rows, own, level = places.row[mine], turns[column], problem.weights.level[mine]
            wide = level[:, None, None]
            inner[rows] += wide * blocks_times(own, times_blocks(gram[np.ix_(rest, rest)], own))
            aim[rows] += level[:, None] * times_blocks(left.cross[np.ix_(mine, rest)], own)
            shared[rows, :, column] = wide * blocks_times(own, gram[np.ix_(rest, both)])
            normal[rows, column, :, column] = wide * gram[np.ix_(both, both)]
            target[rows, column] = level[:, None] * left.cross[np.ix_(mine, both)]
        held = inverses(inner)
        size = 4 * n_columns
        across = shared.reshape(n_rows, len(rest), size)
        follow = np.matmul(held, across)
        return cls(
            normal.reshape(n_rows, size, size) - np.matmul(across.transpose(0, 2, 1), follow),
            target.reshape(n_rows, size) - np.einsum("ik,ikm->im", aim, follow),
            left.power - float(np.sum(aim * np.matmul(held, aim[:, :, None])[:, :, 0])),
        )

    def misfits(self, trials: ComplexArray) -> FloatArray:
        """Return the misfit for each trial, shapes following, (n_trials,) [-].

        Parameters
        ----------
        trials : (n_trials, n_columns, 2) complex array
            Participations of the two modes [-].
        """
        turns = rotations(trials)
        wide = np.zeros((*trials.shape[:2], 4, 4))
        wide[:, :, :2, :2], wide[:, :, 2:, 2:] = turns[:, :, 0], turns[:, :, 1]
        wide = wide.reshape(len(trials), -1, 4)
        gain = np.empty(len(trials))
        for number, own in enumerate(wide):
            normal, target = own.T @ self.normal @ own, self.target @ own
            gain[number] = np.einsum("ik,ikl,il->", target, inverses(normal), target)
        return np.asarray(np.maximum(self.rest - gain, 0.0))
