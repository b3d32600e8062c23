"""Close modes whose shapes are turned in the space they span."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import AnyArray, FloatArray, IntArray
from identification.mac import mac, subspace_mac

_LARGEST = 3
_ALIKE = 0.9


@dataclass(frozen=True)
class Subspace:
    """Close modes of test and model that span the same space, though single shapes do not agree.

    Parameters
    ----------
    test, model : tuple of int
        Numbers of the modes, counted from 0, rising in frequency.
    mac : float
        Squared cosine of the largest angle between the two spaces [-].
    """

    test: tuple[int, ...]
    model: tuple[int, ...]
    mac: float

    @property
    def angle(self) -> float:
        """Largest angle between the two spaces [degree]."""
        return float(np.degrees(np.arccos(np.sqrt(min(self.mac, 1.0)))))


def turned_subspaces(
    frequency: tuple[AnyArray, AnyArray],
    shapes: tuple[AnyArray, AnyArray],
    *,
    factor: float = 1.0,
    close: float = 0.1,
    min_mac: float = 0.9,
) -> tuple[Subspace, ...]:
    """Find groups of two or three close modes that test and model mix differently.

    Parameters
    ----------
    frequency : tuple of (n_test,) and (n_model,) arrays
        Frequencies [Hz].
    shapes : tuple of (n_dofs, n_test) and (n_dofs, n_model) arrays
        Shapes at the same degrees of freedom, twice as many as modes in a group at least [any unit].
    factor : float
        What model frequencies have in common over those of the test [-].
    close : float
        Largest relative distance between neighbours in a group, and of a group from its place [-].
    min_mac : float
        Least squared cosine of the largest angle [-].

    Returns
    -------
    tuple of Subspace
        No mode stands in two of them; modes that agree one by one stand in none.
    """
    single = mac(*shapes)
    found: list[Subspace] = []
    for size in range(2, _LARGEST + 1):
        tests, models = (_runs(np.asarray(f, dtype=float), size, close) for f in frequency)
        some = [
            Subspace(tuple(i.tolist()), tuple(j.tolist()), subspace_mac(shapes[0][:, i], shapes[1][:, j]))
            for i in tests
            for j in models
            if _near(frequency[0][i], frequency[1][j], factor, close)
            and _worst(single[np.ix_(i, j)]) < _ALIKE
        ]
        for best in sorted(some, key=lambda s: -np.nan_to_num(s.mac, nan=-1.0)):
            if best.mac >= min_mac and not any(_overlap(best, other) for other in found):
                found.append(best)
    return tuple(sorted(found, key=lambda s: s.test))


def _runs(frequency: FloatArray, size: int, close: float) -> list[IntArray]:
    """Return runs of neighbours in frequency."""
    order = np.argsort(frequency)
    near = np.diff(np.log(frequency[order])) <= close
    starts = range(len(order) - size + 1)
    return [order[k : k + size] for k in starts if near[k : k + size - 1].all()]


def _near(test: AnyArray, model: AnyArray, factor: float, close: float) -> bool:
    return bool(abs(np.mean(np.log(model)) - np.mean(np.log(test)) - np.log(factor)) <= 2.0 * close)


def _worst(single: FloatArray) -> float:
    """Return the lowest MAC of the best one-to-one assignment in a group."""
    return float(single[linear_sum_assignment(-np.nan_to_num(single))].min())


def _overlap(one: Subspace, other: Subspace) -> bool:
    return bool(set(one.test) & set(other.test) or set(one.model) & set(other.model))
