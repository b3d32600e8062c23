"""Every effect's curve, or surface, through the space of the data, by re-solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy.interpolate import Akima1DInterpolator, make_interp_spline

from acquisition.arrays import BoolArray, FloatArray, IntArray
from modalkit.planning.family import Family

_BETWEEN, _DENSER, _APART = 5, 3, 4
_CUBIC = 3
_LINEAR = 10.0
"""Severities of so many times the smallest are where the scale turns from linear to logarithmic [-]."""

ROUNDS = 5
"""So often severities are halved where a curve is not met between them: to a thirtieth of what they were."""

MISSED = 0.5
"""A curve is met between two severities within so many standard deviations [-]..."""

SHARE = 1.0
"""...or within this share of the doubt in its own idealisation [-]: then it is off by one sigma of a rival's."""


@dataclass(frozen=True, eq=False)
class Dense:
    """Severities that follow how a curve bends.

    Parameters
    ----------
    severities : (n,) array
        Rising [SI].
    data : (n_places, n, n_data) array
        Change of the data there [-].
    """

    severities: FloatArray
    data: FloatArray


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
    dense : Dense or None
        More severities, where it bends; None is those of the family.
    """

    family: Family
    data: FloatArray
    fidelity: float = 0.0
    slack: FloatArray | None = None
    dense: Dense | None = None

    @cached_property
    def severities(self) -> FloatArray:
        """Fine severities, (n_fine,) [SI]."""
        if self.dense is not None:
            return _finer(self.dense.severities, _DENSER)
        return _finer(self.family.grid, _BETWEEN if self.family.graded else 1)

    @cached_property
    def cloud(self) -> FloatArray:
        """Interpolated data, (n_fine_places, n_fine, n_data) [-].

        An effect between two places changes the data nearly as it would in parts at both.
        """
        data: Any = self.data
        even = partial(_even, family=self.family)
        if self.dense is not None:
            data = _between(self.dense.severities, self.dense.data, self.severities, self.family)
        elif self.family.graded:
            data = make_interp_spline(even(self.family.grid), data, k=_CUBIC, axis=1)(even(self.severities))
        if len(data) > 1 and not self.family.separately:
            rank = np.arange(float(len(data)))
            data = make_interp_spline(rank, data, k=1, axis=0)(_finer(rank, _APART))
        cloud: FloatArray = data
        return cloud


def _even(q: FloatArray, family: Family) -> FloatArray:
    """Map severities, dense around 0, to a scale on which the curves bend evenly."""
    return np.asarray(np.arcsinh(q / _linear(family)))


def _linear(family: Family) -> float:
    """Return the severity where that scale turns from linear to logarithmic [SI]."""
    return float(_LINEAR * family.finest * np.abs(family.grid).max())


def _between(known: FloatArray, data: FloatArray, wanted: FloatArray, family: Family) -> FloatArray:
    """Return data at severities between those known, by a curve that bends only where its neighbours do."""
    return np.asarray(Akima1DInterpolator(_even(known, family), data, axis=1)(_even(wanted, family)))


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


def refined(curve: Curve, change: Change, white: FloatArray, have: IntArray) -> Curve:
    """Return a curve with more severities where it bends, as a test sees it.

    Parameters
    ----------
    curve : Curve
        The effect, of several severities.
    change : callable
        What it changes.
    white : (n, n) array
        What whitens the data of the test.
    have : (n,) int array
        Which data these are.
    """
    family, known, data = curve.family, curve.family.grid, curve.data

    def far(missed: FloatArray, whole: FloatArray) -> BoolArray:
        """Tell at which places and severities a curve is missed by more than is allowed."""
        off, size = (np.linalg.norm(one[..., have] @ white.T, axis=-1) for one in (missed, whole))
        return np.asarray(off > np.hypot(MISSED, SHARE * curve.fidelity * size))

    loud = far(data, 0 * data)
    bends = loud[:, 1:] | loud[:, :-1]
    for _ in range(ROUNDS):
        chosen = np.flatnonzero(bends.any(axis=0))
        if not len(chosen):
            break
        middle = _middle(known, family)[chosen]
        found = _between(known, data, middle, family)
        bad = np.zeros_like(bends)
        for place, i in np.argwhere(bends[:, chosen]):  # where a curve is met already, what is between stands
            solved = change(family, float(middle[i]), float(family.sites[place]))
            bad[place, chosen[i]] = far(solved - found[place, i], solved)
            found[place, i] = solved
        halves = np.repeat(bad, np.where(bends.any(axis=0), 2, 1), axis=1)
        known = np.insert(known, chosen + 1, middle)
        data = np.insert(data, chosen + 1, found, axis=1)
        bends = halves
    return replace(curve, dense=Dense(known, data))


def _middle(known: FloatArray, family: Family) -> FloatArray:
    """Return the middles between severities on the scale on which curves bend evenly, (n - 1,) [SI]."""
    scale = _even(known, family)
    return np.asarray(_linear(family) * np.sinh((scale[1:] + scale[:-1]) / 2))
