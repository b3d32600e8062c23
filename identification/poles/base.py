"""What every pole estimator takes and gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from acquisition import errors
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.display import Displayed
from acquisition.frfs import frf


@dataclass(frozen=True, eq=False)
class PoleSets(Displayed):
    """Poles found at each of several model orders, physical and mathematical ones alike.

    Parameters
    ----------
    orders : tuple of int
        Model orders, rising.
    poles : tuple of (n_poles,) complex arrays
        Poles in the Laplace plane, decay of the exponential window removed [rad/s].
    participation : tuple of (n_poles, n_references) complex arrays
        Participation of each reference, unit length; a column of ones for single-reference estimators [-].
    """

    orders: tuple[int, ...]
    poles: tuple[ComplexArray, ...]
    participation: tuple[ComplexArray, ...]


class FindPoles(Protocol):
    """A way from FRFs to the poles of many model orders."""

    def __call__(self, frfs: frf.FrfSet, *, orders: Sequence[int]) -> PoleSets:
        """Return the poles at each order.

        Parameters
        ----------
        frfs : FrfSet
            The FRFs, already cut to the band.
        orders : sequence of int
            Model orders: the number of poles, or, of a poly-reference estimator, of poles per reference [-].
        """
        ...


@dataclass(frozen=True)
class PoleEstimator:
    """An entry of the registry of estimators.

    Parameters
    ----------
    find : callable
        The estimator, ``find(frfs, orders=...)``.
    poly_reference : bool
        Whether an order counts the poles of each reference; if not, those of all together.
    any_order : bool
        Whether the order may be raised up to half as many as there are lines, where the FRFs hold many modes.
    """

    find: FindPoles
    poly_reference: bool = False
    any_order: bool = False

    def __call__(self, frfs: frf.FrfSet, *, orders: Sequence[int]) -> PoleSets:
        """Return the poles at each order."""
        return self.find(frfs, orders=orders)


@dataclass(frozen=True)
class Baseband:
    """The band mapped onto the unit circle, z = exp((s - decay - i origin) step).

    Parameters
    ----------
    origin : float
        Circular frequency mapped to z = 1: the middle of the band [rad/s].
    step : float
        Sampling interval of the equivalent time signal [s].
    decay : float
        Decay of the exponential window still in the FRFs [1/s].
    """

    origin: float
    step: float
    decay: float

    @classmethod
    def of(cls, frfs: frf.FrfSet, circle: int) -> Baseband:
        """Map the lines of ``frfs`` onto a circle that would hold ``circle`` lines."""
        middle = 0.5 * float(frfs.frequency[0] + frfs.frequency[-1])
        return cls(2 * np.pi * middle, 1.0 / (circle * frfs.df), frfs.decay)

    def poles(self, z: ComplexArray) -> ComplexArray:
        """Return the poles in the Laplace plane [rad/s] of roots z."""
        return np.asarray(np.log(z) / self.step + 1j * self.origin + self.decay)


def row_scale(frfs: frf.FrfSet) -> FloatArray:
    """Return one weight per FRF, the reciprocal of its r.m.s. in the band, shape (n_frf,).

    Raises
    ------
    EstimationError
        If every FRF is zero.
    """
    level = np.sqrt(np.mean(np.abs(frfs.values) ** 2, axis=1))
    if not level.max() > 0:
        raise errors.EstimationError(f"{frfs.source}: all FRFs are zero in the band; there is nothing to fit")
    return np.asarray(1.0 / np.maximum(level, 1e-3 * level.max()))
