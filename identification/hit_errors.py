"""How each hit moves the modal constants of an FRF: errors that its modes share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray, frozen_array
from acquisition.display import Displayed


@dataclass(frozen=True, eq=False)
class HitErrors(Displayed):
    """What each hit adds to the errors of the modal constants, the poles held.

    A hit that misses its point moves the constants of all modes together. The sum of products over the hits is the
    covariance of an FRF's constants; no formula with one standard deviation for each constant holds it.

    Parameters
    ----------
    deviations : (n_frf, n_hits, n_modes) array
        What each hit adds to the error of the mean; zero where an FRF has fewer hits than others [1/kg].
    freedom : (n_frf,) array
        Degrees of freedom behind them: hits less one for each group of hits [-].
    white : (n_frf, n_modes) array
        Standard deviation of each constant if lines erred independently, as the weights of the fit state [1/kg].
    hits : (n_frf,) int array
        Which hits each FRF was averaged over: FRFs recorded at once have the same [-].
    misfit : (n_modes,) array
        By what factor the misfit of the fit raises the variance: errors that all hits share [-].
    """

    deviations: FloatArray
    freedom: FloatArray
    white: FloatArray
    hits: IntArray
    misfit: FloatArray

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for name in ("deviations", "freedom", "white", "misfit"):
            object.__setattr__(self, name, frozen_array(getattr(self, name)))
        object.__setattr__(self, "hits", frozen_array(self.hits, np.int64))

    def rows(self, rows: IntArray) -> Self:
        """Return those of some FRFs."""
        return type(self)(
            self.deviations[rows], self.freedom[rows], self.white[rows], self.hits[rows], self.misfit
        )

    def modes(self, keep: BoolArray | IntArray) -> Self:
        """Return those of some modes."""
        return type(self)(
            self.deviations[:, :, keep], self.freedom, self.white[:, keep], self.hits, self.misfit[keep]
        )

    def count(self) -> IntArray:
        """Return the number of hits of each FRF, (n_frf,)."""
        return np.asarray(np.any(self.deviations != 0.0, axis=2).sum(axis=1), dtype=np.int64)
