"""One line of elements: polynomials of any degree between breaks, integrated by Gauss's rule."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.interpolate import BarycentricInterpolator

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Line:
    """Elements along one axis.

    Parameters
    ----------
    breaks : (n + 1,) array
        Ends of the elements [m].
    degree : int
        Degree of the polynomials [-].
    """

    breaks: Floats
    degree: int

    @property
    def size(self) -> int:
        """Number of nodes."""
        return (len(self.breaks) - 1) * self.degree + 1

    @cached_property
    def _local(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Gauss points and weights on [0, 1], and values and slopes of the local polynomials there."""
        x, w = np.polynomial.legendre.leggauss(self.degree + 1)
        x, w = (x + 1) / 2, w / 2
        return x, w, *_lagrange(self.degree, x)

    @cached_property
    def points(self) -> Floats:
        """Gauss points of all elements [m]."""
        x = self._local[0]
        return np.asarray((self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * x).ravel())

    @cached_property
    def weights(self) -> Floats:
        """Their weights [m]."""
        return np.asarray((np.diff(self.breaks)[:, None] * self._local[1]).ravel())

    @cached_property
    def values(self) -> sparse.csr_array:
        """Nodal values to values at the Gauss points."""
        return self._spread(np.tile(self._local[2], (len(self.breaks) - 1, 1, 1)))

    @cached_property
    def slopes(self) -> sparse.csr_array:
        """Nodal values to slopes at the Gauss points [1/m]."""
        return self._spread(self._local[3][None] / np.diff(self.breaks)[:, None, None])

    def rows(self, x: Floats) -> sparse.csr_array:
        """Nodal values to values at any places [m]."""
        x = np.clip(x, self.breaks[0], self.breaks[-1])
        element = np.clip(np.searchsorted(self.breaks, x, side="right") - 1, 0, len(self.breaks) - 2)
        local = (x - self.breaks[element]) / np.diff(self.breaks)[element]
        return self._place(_lagrange(self.degree, local)[0], element)

    def _spread(self, blocks: Floats) -> sparse.csr_array:
        count = blocks.shape[1]
        element = np.repeat(np.arange(len(self.breaks) - 1), count)
        return self._place(blocks.reshape(-1, self.degree + 1), element)

    def _place(self, values: Floats, element: NDArray[np.int64]) -> sparse.csr_array:
        columns = element[:, None] * self.degree + np.arange(self.degree + 1)
        rows = np.repeat(np.arange(len(values)), self.degree + 1)
        shape = (len(values), self.size)
        return sparse.csr_array((values.ravel(), (rows, columns.ravel())), shape=shape)


def _lagrange(degree: int, x: Floats) -> tuple[Floats, Floats]:
    """Values and slopes at x in [0, 1] of the polynomials that are 1 at one of the Chebyshev-Lobatto nodes."""
    nodes = (1 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2
    unit = BarycentricInterpolator(nodes, np.eye(degree + 1))
    powers = np.linalg.inv(np.vander(nodes, increasing=True))
    slopes = np.vander(x, degree, increasing=True) * np.arange(1, degree + 1)
    return np.asarray(unit(x)), np.asarray(slopes @ powers[1:])


def graded(cuts: Floats, count: int, pull: float = 0.3) -> Floats:
    """Return breaks on [0, 1], denser towards both ends, with the cuts among them."""
    even = np.linspace(0.0, 1.0, count + 1)
    base = (1 - pull) * even + pull * (1 - np.cos(np.pi * even)) / 2
    kept = [b for b in base[1:-1] if np.abs(b - cuts).min(initial=1.0) > 0.2 / count]
    return np.unique(np.concatenate([[0.0, 1.0], kept, cuts[(cuts > 0) & (cuts < 1)]]))
