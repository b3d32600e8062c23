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
        """Return the groups beside columns of data (n, c), with noises of so much variance each (b, n) [-]."""
        if not len(self.starts):
            return Beside(
                self, *(np.zeros((len(variance), 0, *end)) for end in ((0,), (0, 0), (0, data.shape[1])))
            )
        power, turn, rotated = self._rotated(variance)
        return Beside(self, power, turn, self._products(rotated, data))

    def precise(self, variance: FloatArray, data: FloatArray) -> FloatArray:
        """Return ``(D + L L^T)^-1`` times columns (n, c): noise (n,) and groups integrated out [-]."""
        found = data / variance[:, None]
        if not len(self.starts):
            return found
        power, _, rotated = self._rotated(variance[None])
        shares = (self._products(rotated, data) / (1.0 + power)[..., None])[0]
        found[self.rows] -= np.einsum("kq,kqc->kc", rotated[0], np.repeat(shares, self._lengths, axis=0))
        return found

    @property
    def _lengths(self) -> IntArray:
        return np.diff(np.append(self.starts, len(self.rows)))

    def _rotated(self, variance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Turn the nuisances of each group into each other until they are orthogonal beside each noise.

        Returns
        -------
        power : (b, m, q) array
            Their squares beside the noise, the eigenvalues of ``L^T D^-1 L`` [-].
        turn : (b, m, q, q) array
            The eigenvectors, in columns.
        rotated : (b, k, q) array
            ``D^-1 L`` turned.
        """
        over = self.values / variance[:, self.rows, None]
        power, turn = np.linalg.eigh(self._summed(over[..., None] * self.values[:, None, :]))
        rotated = np.einsum("bkq,bkqr->bkr", over, np.repeat(turn, self._lengths, axis=1))
        return np.maximum(power, 0.0), turn, rotated

    def _products(self, rotated: FloatArray, data: FloatArray) -> FloatArray:
        return self._summed(rotated[..., None] * data[self.rows][:, None, :])

    def _summed(self, terms: FloatArray) -> FloatArray:
        """Add up what belongs to the rows of each group, (b, k, ...)."""
        return np.add.reduceat(terms, self.starts, axis=1)


@dataclass(frozen=True, eq=False)
class Beside:
    """Groups of nuisances beside columns of data and b noises, those of the shapes to be scaled.

    Parameters
    ----------
    groups : Separate
        Which they are.
    power : (b, m, q) array
        Squares of the turned nuisances beside the noise [-].
    turn : (b, m, q, q) array
        How they were turned.
    products : (b, m, q, c) array
        What they have in common with the columns [-].
    """

    groups: Separate
    power: FloatArray
    turn: FloatArray
    products: FloatArray

    def _reduced(self, scales: FloatArray) -> FloatArray:
        """By how much the noises (s,) of each group take from its squares, (s, m, 1) [-]."""
        return np.where(self.groups.scaled, scales[:, None] ** -2, 1.0)[..., None]

    def share(self, scales: FloatArray) -> FloatArray:
        """Return what the groups explain of the Gram matrix of the columns at scales (s,), (b, s, c, c) [-]."""
        count, (noises, groups, size) = self.products.shape[-1], self.power.shape
        if not groups:
            return np.zeros((noises, len(scales), count, count))
        reduced = self._reduced(scales)
        weights = (reduced**2 / (1.0 + reduced * self.power[:, None])).reshape(noises, len(scales), 1, -1)
        flat = self.products.reshape(noises, 1, groups * size, count)
        return np.asarray((np.swapaxes(flat, 2, 3) * weights) @ flat)

    def log_det(self, scales: FloatArray) -> FloatArray:
        """Return the logarithm of the determinant of what they add to the noise at scales (s,), (b, s) [-]."""
        return np.asarray(np.log1p(self._reduced(scales) * self.power[:, None]).sum(axis=(2, 3)))

    def fill(self, shift: FloatArray, noise: int, scale: float, left: FloatArray) -> None:
        """Put the most probable values beside one noise into ``shift`` (p,), the columns adding up by ``left`` (c,)."""
        if not self.power.shape[1]:
            return
        reduced, columns = self._reduced(np.array([scale]))[0], self.groups.columns
        turned = reduced * (self.products[noise] @ left) / (1.0 + reduced * self.power[noise])
        values = np.einsum("mqr,mr->mq", self.turn[noise], turned)
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
