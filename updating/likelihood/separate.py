"""Nuisances that have data of their own: found by where they are zero, and integrated out one by one.

Where one point was really hit changes the constants of that point and of no other. Sixty points have some two hundred
such nuisances, a hundredth of whose sensitivities is not zero. Groups of columns that touch different rows are
independent once what all data have in common is given: with the noise ``D`` and their sensitivities ``L``,

    log det (I + L^T D^-1 L) = sum of those of the groups,

and what is left for the common nuisances is the Schur complement (Golub and Van Loan, Matrix Computations, 4.2.4). The
work grows with the number of data, not with the cube of the number of points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.thresholds import FEW_NUISANCES, MOST_TOGETHER


@dataclass(frozen=True, eq=False)
class Separate:
    """Groups of nuisances, each of which changes rows that no other group does.

    Parameters
    ----------
    columns : (m, q) int array
        Nuisances of each group, -1 where it has fewer than q.
    rows : (k,) int array
        Data that they change, those of a group together.
    starts : (m,) int array
        Where the rows of each group begin.
    values : (k, q) array
        Sensitivities there, zero where a group has fewer columns [-].
    scaled : (m,) bool array
        Which groups change data whose noise has an unknown scale.
    common : (c,) int array
        The nuisances that are in no group and change anything.
    """

    columns: IntArray
    rows: IntArray
    starts: IntArray
    values: FloatArray
    scaled: BoolArray
    common: IntArray

    def beside(self, variance: FloatArray, data: FloatArray) -> Beside:
        """Return the groups beside columns of data (n, c), with a noise of so much variance (n,) [-]."""
        if not len(self.starts):
            return Beside(self, np.zeros((0, 0)), np.zeros((0, 0, 0)), np.zeros((0, 0, data.shape[1])))
        power, turn, rotated = self._rotated(variance)
        return Beside(self, power, turn, self._products(rotated, data))

    def precise(self, variance: FloatArray, data: FloatArray) -> FloatArray:
        """Return ``(D + L L^T)^-1`` times columns (n, c): noise and groups integrated out [-]."""
        found = data / variance[:, None]
        if not len(self.starts):
            return found
        power, _, rotated = self._rotated(variance)
        shares = self._products(rotated, data) / (1.0 + power)[:, :, None]
        found[self.rows] -= np.einsum("kq,kqc->kc", rotated, np.repeat(shares, self._lengths, axis=0))
        return found

    @property
    def _lengths(self) -> IntArray:
        return np.diff(np.append(self.starts, len(self.rows)))

    def _rotated(self, variance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Turn the nuisances of each group into each other until they are orthogonal beside the noise.

        Returns
        -------
        power : (m, q) array
            Their squares beside the noise, the eigenvalues of ``L^T D^-1 L`` [-].
        turn : (m, q, q) array
            The eigenvectors, in columns.
        rotated : (k, q) array
            ``D^-1 L`` turned.
        """
        over = self.values / variance[self.rows, None]
        power, turn = np.linalg.eigh(self._summed(over[:, :, None] * self.values[:, None, :]))
        rotated = np.einsum("kq,kqr->kr", over, np.repeat(turn, self._lengths, axis=0))
        return np.maximum(power, 0.0), turn, rotated

    def _products(self, rotated: FloatArray, data: FloatArray) -> FloatArray:
        return self._summed(rotated[:, :, None] * data[self.rows][:, None, :])

    def _summed(self, terms: FloatArray) -> FloatArray:
        """Add up what belongs to the rows of each group."""
        return np.add.reduceat(terms, self.starts)


@dataclass(frozen=True, eq=False)
class Beside:
    """Groups of nuisances beside columns of data, the noise of the shapes to be scaled.

    Parameters
    ----------
    groups : Separate
        Which they are.
    power : (m, q) array
        Squares of the turned nuisances beside the noise [-].
    turn : (m, q, q) array
        How they were turned.
    products : (m, q, c) array
        What they have in common with the columns [-].
    """

    groups: Separate
    power: FloatArray
    turn: FloatArray
    products: FloatArray

    def _reduced(self, scale: float) -> FloatArray:
        """By how much the noise of each group takes from its squares, (m, 1) [-]."""
        return np.where(self.groups.scaled, scale**-2, 1.0)[:, None]

    def share(self, scale: float) -> FloatArray:
        """Return what the groups explain of the Gram matrix (c, c) of the columns [-]."""
        if not len(self.power):
            return np.zeros((self.products.shape[2],) * 2)
        reduced, count = self._reduced(scale), self.products.shape[2]
        weights = (reduced**2 / (1.0 + reduced * self.power)).reshape(-1, 1)
        flat = self.products.reshape(-1, count)
        return np.asarray(flat.T @ (weights * flat))

    def log_det(self, scale: float) -> float:
        """Return the logarithm of the determinant of what they add to the noise [-]."""
        if not len(self.power):
            return 0.0
        return float(np.sum(np.log1p(self._reduced(scale) * self.power)))

    def fill(self, shift: FloatArray, scale: float, left: FloatArray) -> None:
        """Put the most probable values into their places of ``shift`` (p,), the columns adding up by ``left`` (c,)."""
        if not len(self.power):
            return
        reduced, columns = self._reduced(scale), self.groups.columns
        turned = reduced * (self.products @ left) / (1.0 + reduced * self.power)
        values = np.einsum("mqr,mr->mq", self.turn, turned)
        shift[columns[columns >= 0]] = values[columns >= 0]


def separate(nuisance: FloatArray, scaled: BoolArray) -> Separate:
    """Return the groups of nuisances that have data of their own.

    Parameters
    ----------
    nuisance : (n, p) array
        Sensitivities [-].
    scaled : (n,) bool array
        Which data have noise of an unknown scale; a group has such data or others, not both.
    """
    touched = nuisance != 0
    count = touched.sum(axis=0) if nuisance.shape[1] > FEW_NUISANCES else np.zeros(0, dtype=np.int64)
    if not count.any():
        none = np.zeros(0, dtype=np.int64)
        empty = np.zeros((0, 0))
        every = np.flatnonzero(touched.any(axis=0))
        return Separate(none.reshape(0, 0), none, none, empty, none.astype(bool), every)
    fewest_first = np.argsort(count, kind="stable")
    order = fewest_first[count[fewest_first] > 0]
    owner, owned = _owners(touched[:, order], scaled)
    owners, group, size = np.unique(owned, return_inverse=True, return_counts=True)
    wanted = (owners >= 0) & (size <= MOST_TOGETHER)
    taken = wanted[group]
    # columns of each group, filled up with -1
    rank = (np.cumsum(wanted) - 1)[group[taken]]
    by_group = np.argsort(rank, kind="stable")
    sizes = size[wanted]
    columns = np.full((len(sizes), int(sizes.max(initial=0))), -1)
    place = np.arange(len(rank)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    columns[rank[by_group], place] = order[taken][by_group]
    rows, index = _rows(owner, owners[wanted])
    own = columns[index]
    values = np.where(own < 0, 0.0, nuisance[rows[:, None], own])
    starts = np.searchsorted(index, np.arange(len(sizes)))
    return Separate(columns, rows, starts, values, owners[wanted] % 2 == 1, np.sort(order[~taken]))


def _owners(touched: BoolArray, scaled: BoolArray) -> tuple[IntArray, IntArray]:
    """Return to which nuisance each row belongs, (n,), and each nuisance's rows, (p,); -1 where to none or several.

    A row belongs to the first nuisance that changes it, a nuisance to the one that owns all its rows: two that belong
    to different ones share no row. Odd numbers are those of rows whose noise has an unknown scale.
    """
    owner = np.where(touched.any(axis=1), 2 * touched.argmax(axis=1) + scaled, -1)
    highest = np.where(touched, owner[:, None], -1).max(axis=0)
    lowest = np.where(touched, owner[:, None], 2 * touched.shape[1]).min(axis=0)
    return owner, np.where(highest == lowest, highest, -1)


def _rows(owner: IntArray, owners: IntArray) -> tuple[IntArray, IntArray]:
    """Return the rows that belong to some owners, in their order, and the rank of each row's owner."""
    rank = np.full(int(owner.max(initial=0)) + 2, -1)
    rank[owners] = np.arange(len(owners))
    index = rank[owner]
    mine = np.flatnonzero(index >= 0)
    rows = mine[np.argsort(index[mine], kind="stable")]
    return rows, index[rows]
