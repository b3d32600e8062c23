"""The stabilisation chart: which poles stay where they are as the model order rises."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen_array
from acquisition.display import Displayed, counted
from identification.poles.base import PoleSets

_FREQUENCY = 0.005
_DAMPING = 0.4
_PARTICIPATION = 0.3
_HEAVY = 0.35


@dataclass(frozen=True, eq=False)
class StabilisationChart(Displayed):
    """Every pole of every order, and how it hangs together with the poles of the orders below.

    Parameters
    ----------
    orders : (n_orders,) int array
        Model orders, rising [-].
    level : (n_poles,) int array
        Which of the orders each pole belongs to [-].
    poles : (n_poles,) complex array
        Poles [rad/s].
    participation : (n_poles, n_references) complex array
        Unit participation vectors [-].
    track : (n_poles,) int array
        Number of the chain of poles, one per order at the most, that each pole belongs to [-].
    band : tuple of float
        The band asked for [Hz].
    """

    orders: IntArray
    level: IntArray
    poles: ComplexArray
    participation: ComplexArray
    track: IntArray
    band: tuple[float, float]

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for name, dtype in (("orders", np.int64), ("level", np.int64), ("track", np.int64)):
            object.__setattr__(self, name, frozen_array(getattr(self, name), dtype))
        for name in ("poles", "participation"):
            object.__setattr__(self, name, frozen_array(getattr(self, name), np.complex128))

    @property
    def frequency(self) -> FloatArray:
        """Undamped natural frequency of every pole, shape (n_poles,) [Hz]."""
        return np.abs(self.poles) / (2 * np.pi)

    @property
    def damping(self) -> FloatArray:
        """Damping ratio of every pole, shape (n_poles,) [-]."""
        return np.asarray(-self.poles.real / np.abs(self.poles))

    @property
    def stable(self) -> BoolArray:
        """Whether a pole continues one of the order below, shape (n_poles,)."""
        first = np.full(self.track.max(initial=-1) + 1, len(self.orders), dtype=np.int64)
        np.minimum.at(first, self.track, self.level)
        return np.asarray(self.level > first[self.track])

    def table(self) -> pd.DataFrame:
        """Return one row per pole: order, frequency [Hz], damping ratio [%], stable, track."""
        return pd.DataFrame(
            {
                "order": self.orders[self.level],
                "frequency [Hz]": self.frequency,
                "damping [%]": 100 * self.damping,
                "stable": self.stable,
                "track": self.track,
            }
        )

    def _headline(self) -> str:
        return (
            f"{counted(len(self.poles), 'pole')} of {counted(len(self.orders), 'order')}, {int(self.stable.sum())} "
            f"stable, {self.band[0]:g} to {self.band[1]:g} Hz"
        )


def stabilise(sets: PoleSets, *, band: tuple[float, float]) -> StabilisationChart:
    """Chain the poles of successive orders.

    A pole continues the chain whose last pole, one or two orders below, is its nearest neighbour and it
    that one's: nearest in frequency, damping and participation together, so that two close modes found at
    the same order stay two.

    Parameters
    ----------
    sets : PoleSets
        Poles of every order.
    band : tuple of float
        The band asked for [Hz].

    Returns
    -------
    StabilisationChart
        The plausible poles: Im > 0, damping ratio between -5 and 35 %.
    """
    found, parts = np.concatenate(sets.poles), np.concatenate(sets.participation)
    kept = _plausible(found)
    level = np.repeat(np.arange(len(sets.poles)), [len(p) for p in sets.poles])[kept]
    all_poles, all_parts = found[kept], parts[kept]
    track = np.full(len(all_poles), -1, dtype=np.int64)
    starts = np.searchsorted(level, np.arange(len(sets.poles) + 1))
    n_tracks = 0
    for i in range(len(sets.poles)):
        here = np.arange(starts[i], starts[i + 1])
        for back in (1, 2):
            if i >= back:
                _continue(
                    all_poles, all_parts, track, here, np.arange(starts[i - back], starts[i - back + 1])
                )
        fresh = here[track[here] < 0]
        track[fresh] = n_tracks + np.arange(len(fresh))
        n_tracks += len(fresh)
    return StabilisationChart(np.array(sets.orders), level, all_poles, all_parts, track, band)


def _plausible(poles: ComplexArray) -> BoolArray:
    size = np.maximum(np.abs(poles), np.finfo(float).tiny)
    return np.asarray((poles.imag > 0) & (poles.real < 0.05 * size) & (-poles.real < _HEAVY * size))


def _continue(
    poles: ComplexArray, parts: ComplexArray, track: IntArray, here: IntArray, below: IntArray
) -> None:
    """Hand on the track numbers of ``below`` to their mutual nearest neighbours in ``here``, in place."""
    free = np.ones(len(track) + 1, dtype=bool)
    free[track[here]] = False
    here, below = here[track[here] < 0], below[free[track[below]]]
    if len(here) == 0 or len(below) == 0:
        return
    distance = separation(poles[here], parts[here], poles[below], parts[below])
    to_below, to_here = distance.argmin(axis=1), distance.argmin(axis=0)
    rows = np.arange(len(here))
    mutual = (to_here[to_below] == rows) & (distance[rows, to_below] < 1.0)
    track[here[mutual]] = track[below[to_below[mutual]]]


def separation(p: ComplexArray, u: ComplexArray, q: ComplexArray, v: ComplexArray) -> FloatArray:
    """Return how far poles p stand from poles q, shape (n_p, n_q) [-]; under 1 they may be the same.

    Frequencies are compared on 0.5 %, or on 0.3 half-power bandwidths where that is more; dampings on 40 %;
    participation vectors by 1 - MAC on 0.3.
    """
    size = 0.5 * (np.abs(p)[:, None] + np.abs(q)[None, :])
    damping_p, damping_q = np.abs(p.real)[:, None], np.abs(q.real)[None, :]
    width = 0.5 * (damping_p + damping_q)
    in_frequency = np.abs(np.abs(p)[:, None] - np.abs(q)[None, :]) / np.maximum(
        _FREQUENCY * size, 0.3 * width
    )
    in_damping = np.abs(damping_p - damping_q) / (_DAMPING * np.maximum(width, 1e-4 * size))
    mac = np.abs(u.conj() @ v.T) ** 2
    return np.asarray(np.sqrt(in_frequency**2 + in_damping**2 + ((1 - mac) / _PARTICIPATION) ** 2))
