"""Every effect's curve, or surface, through the space of the data, by re-solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from acquisition.arrays import FloatArray
from modalkit.planning.family import Family

_BETWEEN = 5
_CUBIC = 3


@dataclass(frozen=True, eq=False)
class Curve:
    """One effect in the space of the data.

    Parameters
    ----------
    family : Family
        The effect.
    data : (n_places, n_severities, n_data) array
        Change of the data by the effect [-].
    fidelity : float
        How far the idealisation of who takes it for a cause may be off, of the change [-].
    slack : (n_data,) array or None
        What such a one leaves in doubt of the data beside that, 1 sigma; None is nothing [-].
    """

    family: Family
    data: FloatArray
    fidelity: float = 0.0
    slack: FloatArray | None = None

    @cached_property
    def severities(self) -> FloatArray:
        """Fine severities, (n_fine,) [SI]."""
        return _finer(self.family.grid, _BETWEEN if self.family.graded else 1)

    @cached_property
    def places(self) -> FloatArray:
        """Fine places, (n_fine_places,) [m]."""
        sites = self.family.sites
        return _finer(sites, _BETWEEN) if self._spread else sites

    @property
    def _spread(self) -> bool:
        return len(self.family.sites) > _CUBIC and not self.family.separately

    @cached_property
    def cloud(self) -> FloatArray:
        """Interpolated data, (n_fine_places, n_fine, n_data) [-]."""
        data: Any = self.data
        if self.family.graded:
            data = make_interp_spline(_even(self.family.grid), data, k=_CUBIC, axis=1)(_even(self.severities))
        if self._spread:
            data = make_interp_spline(self.family.sites, data, k=_CUBIC, axis=0)(self.places)
        cloud: FloatArray = data
        return cloud


def _even(q: FloatArray) -> FloatArray:
    """Map severities, dense around 0, to a scale on which the curves bend evenly."""
    end = np.abs(q).max()
    return np.asarray(np.arcsinh(q / (1e-2 * end)))


def _finer(values: FloatArray, between: int) -> FloatArray:
    steps = np.arange(len(values) - 1)[:, None] + np.arange(between)[None, :] / between
    fine: FloatArray = np.interp(np.append(steps.ravel(), len(values) - 1), np.arange(len(values)), values)
    return fine


Change = Callable[[Family, float, float], FloatArray]
"""What an effect of a severity at a place changes of the data, (n_data,) [-]."""


def solve_curve(
    family: Family, change: Change, *, fidelity: float = 0.0, slack: FloatArray | None = None
) -> Curve:
    """Solve an effect at all its severities and places.

    Parameters
    ----------
    family : Family
        The effect.
    change : callable
        What it changes.
    fidelity, slack
        As in :class:`Curve`.
    """
    data = np.array([[change(family, float(q), float(place)) for q in family.grid] for place in family.sites])
    return Curve(family, data, fidelity, slack)
