"""Force and exponential windows that leave the amplitude alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.hammer import HammerTest


@dataclass(frozen=True)
class Windows:
    """Windows for the records of a hammer test.

    Parameters
    ----------
    decay : float
        Decay rate of an exponential window exp(-decay (t - t0)), with t0 the time of the peak of the force of
        each hit [1/s]. Force and responses are both windowed: what results are exact samples of
        H(i omega + decay), and the amplitude at the hit is left as it is.
    force_length : float or None
        Time after the peak of the force at which the force is taken for zero, with a cosine taper over the
        last fifth [s]; None leaves the force alone.

    Raises
    ------
    InputError
        If a number is negative.
    """

    decay: float = 0.0
    force_length: float | None = None

    def __post_init__(self) -> None:
        """Check the entries."""
        if self.decay < 0 or (self.force_length is not None and self.force_length <= 0):
            raise InputError(
                f"windows: decay {self.decay}, force length {self.force_length}; both must be positive"
            )


def apply_windows(test: HammerTest, windows: Windows) -> HammerTest:
    """Return the test with windows applied and its ``decay`` raised accordingly.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    windows : Windows
        What to apply.
    """
    time = np.arange(test.samples) / test.rate
    points = []
    for hits in test.points:
        after = time - time[np.abs(hits.force).argmax(axis=-1)][:, None]
        decay = np.exp(-windows.decay * after)
        points.append(
            replace(
                hits,
                force=hits.force * decay * force_window(after, windows.force_length),
                motion=hits.motion * decay[:, None, :],
            )
        )
    return replace(test, points=tuple(points), decay=test.decay + windows.decay)


def force_window(after: FloatArray, length: float | None) -> FloatArray:
    """Return the weight of the force at times after its peak: 1, then a cosine taper to 0 [-].

    Parameters
    ----------
    after : array
        Time after the peak of the force [s].
    length : float or None
        Where the window ends [s]; None for no window.
    """
    if length is None:
        return np.ones_like(after)
    position = np.clip((after - 0.8 * length) / (0.2 * length), 0.0, 1.0)
    return np.asarray(0.5 * (1 + np.cos(np.pi * position)), dtype=np.float64)
