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
from functools import cached_property

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
    scaled : (m,) bool array
        Which groups change data whose noise has an unknown scale.
    common : (c,) int array
        The nuisances that are in no group and change anything.
    """

    columns: IntArray
    rows: IntArray
    starts: IntArray
    scaled: BoolArray
    common: IntArray

    def values(self, nuisance: FloatArray) -> FloatArray:
        """Return the sensitivities of each group on its rows, of all (..., n, p), zero where it has fewer than q.

        Returns
        -------
        (..., k, q) array [-]
        """
        own = np.repeat(self.columns, self._lengths, axis=0)
        return np.where(own < 0, 0.0, nuisance[..., self.rows[:, None], own])

    def beside(self, nuisance: FloatArray, variance: FloatArray, data: FloatArray) -> Beside:
        """Return the groups beside columns of data, with several noises each.

        Parameters
        ----------
        nuisance : (a, n, p) array
            Sensitivities of each comparison [-].
        variance : (a, b, n) array
            Its noises [-].
        data : (a, n, c) array
            Its columns [-].
        """
        if not len(self.starts):
            count, ends = variance.shape[:2], ((0,), (0, 0), (0, data.shape[-1]))
            return Beside(self, *(np.zeros((*count, 0, *end)) for end in ends))
        power, turn, rotated = self._rotated(self.values(nuisance), variance)
        return Beside(self, power, turn, self._products(rotated, data))

    def precise(self, nuisance: FloatArray, variance: FloatArray, data: FloatArray) -> FloatArray:
        """Return ``(D + L L^T)^-1`` times columns (n, c): noise (n,) and groups of (n, p) integrated out [-]."""
        found = data / variance[:, None]
        if not len(self.starts):
            return found
        power, _, rotated = self._rotated(self.values(nuisance)[None], variance[None, None])
        shares = (self._products(rotated, data[None]) / (1.0 + power)[..., None])[0, 0]
        found[self.rows] -= np.einsum("kq,kqc->kc", rotated[0, 0], np.repeat(shares, self._lengths, axis=0))
        return found

    @cached_property
    def _lengths(self) -> IntArray:
        return np.diff(np.append(self.starts, len(self.rows)))

    def _rotated(self, values: FloatArray, variance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Turn the nuisances of each group (a, k, q) into each other until they are orthogonal beside each noise.

        Returns
        -------
        power : (a, b, m, q) array
            Their squares beside the noise, the eigenvalues of ``L^T D^-1 L`` [-].
        turn : (a, b, m, q, q) array
            The eigenvectors, in columns.
        rotated : (a, b, k, q) array
            ``D^-1 L`` turned.
        """
        over = values[:, None] / variance[:, :, self.rows, None]
        power, turn = np.linalg.eigh(self._summed(over[..., None] * values[:, None, :, None, :]))
        rotated = (over[..., None, :] @ np.repeat(turn, self._lengths, axis=2))[..., 0, :]
        return np.maximum(power, 0.0), turn, rotated

    def _products(self, rotated: FloatArray, data: FloatArray) -> FloatArray:
        return self._summed(rotated[..., None] * data[:, None, self.rows, None, :])

    def _summed(self, terms: FloatArray) -> FloatArray:
        """Add up what belongs to the rows of each group, (a, b, k, ...)."""
        return np.add.reduceat(terms, self.starts, axis=2)


@dataclass(frozen=True, eq=False)
class Beside:
    """Groups of nuisances beside columns of data of comparisons, each with b noises, those of the shapes to be scaled.

    Parameters
    ----------
    groups : Separate
        Which they are.
    power : (a, b, m, q) array
        Squares of the turned nuisances beside the noise [-].
    turn : (a, b, m, q, q) array
        How they were turned.
    products : (a, b, m, q, c) array
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
        """Return what the groups explain of the Gram matrix of the columns at scales (s,), (a, b, s, c, c) [-]."""
        (*lead, groups, size), count = self.power.shape, self.products.shape[-1]
        if not groups:
            return np.zeros((*lead, len(scales), count, count))
        reduced = self._reduced(scales)
        weights = (reduced**2 / (1.0 + reduced * self.power[:, :, None])).reshape(*lead, len(scales), 1, -1)
        flat = self.products.reshape(*lead, 1, groups * size, count)
        return np.asarray((np.swapaxes(flat, -1, -2) * weights) @ flat)

    def log_det(self, scales: FloatArray) -> FloatArray:
        """Return the logarithm of the determinant of what they add to the noise at scales (s,), (a, b, s) [-]."""
        return np.asarray(np.log1p(self._reduced(scales) * self.power[:, :, None]).sum(axis=(-2, -1)))

    def fill(self, shift: FloatArray, noise: IntArray, scale: FloatArray, left: FloatArray) -> None:
        """Put the most probable values of each comparison into ``shift`` (a, p).

        Parameters
        ----------
        shift : (a, p) array
            Nuisances of each comparison [standard deviations].
        noise, scale : (a,) arrays
            Which of its noises, and by how much it is scaled [-].
        left : (a, c) array
            By what its columns add up [-].
        """
        if not self.power.shape[2]:
            return
        each, reduced, columns = np.arange(len(shift)), self._reduced(scale), self.groups.columns
        pulled = (self.products[each, noise] @ left[:, None, :, None])[..., 0]
        turned = reduced * pulled / (1.0 + reduced * self.power[each, noise])
        values = (self.turn[each, noise] @ turned[..., None])[..., 0]
        shift[:, columns[columns >= 0]] = values[:, columns >= 0]


def separate(nuisance: FloatArray, scaled: BoolArray) -> Separate:
    """Return the groups of nuisances that have data of their own.

    Parameters
    ----------
    nuisance : (n, p) array
        Sensitivities, or whether there is one [-].
    scaled : (n,) bool array
        Which data have noise of an unknown scale; a group has such data or others, not both.
    """
    touched = nuisance != 0
    count = touched.sum(axis=0) if nuisance.shape[1] > FEW_NUISANCES else np.zeros(0, dtype=np.int64)
    if not count.any():
        none = np.zeros(0, dtype=np.int64)
        every = np.flatnonzero(touched.any(axis=0))
        return Separate(none.reshape(0, 0), none, none, none.astype(bool), every)
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
    starts = np.searchsorted(index, np.arange(len(sizes)))
    return Separate(columns, rows, starts, owners[wanted] % 2 == 1, np.sort(order[~taken]))


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
