"""Force and exponential windows that leave the amplitude alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import special

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.hits.checks import pulse_ends, top_decay, upright, without_drift
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.hits.noise_decay import noise_decay
from acquisition.hits.window_on import windowed_records

QUIET = 16  # samples before a hit that determine the offset of a response


@dataclass(frozen=True)
class Windows:
    """Windows for the records of a hammer test.

    Parameters
    ----------
    decay : float
        Decay rate of an exponential window exp(-decay (t - t0)), with t0 the time of the peak of the force of
        each hit [1/s]. Force and responses are both windowed: what results are exact samples of
        H(i omega + decay), whatever t0 is, so the amplitude is left as it is.
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

    Windows act about the offset of the records, which is taken off first: cut off behind the pulse, an offset
    would become a step, and windowed, a pulse of its own. That of a force goes with its drift; that of a
    response is its mean before the hit, where there are 16 samples of it and it stands out of their noise.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    windows : Windows
        What to apply.
    """
    points = tuple(windowed(hits, windows, test.rate) for hits in test.points)
    return replace(test, points=points, decay=test.decay + windows.decay)


def windowed(hits: Hits, windows: Windows | None, rate: float) -> Hits:
    """Return the hits at one point with windows applied, see `apply_windows`; None leaves them as they are.

    Parameters
    ----------
    hits : Hits
        Raw records.
    windows : Windows or None
        What to apply.
    rate : float
        Sampling rate [Hz].
    """
    if windows is None:
        return hits
    time = np.arange(hits.force.shape[-1]) / rate
    level = without_drift(hits.force)
    after = time - time[np.abs(level).argmax(axis=-1)][:, None]
    decay = np.exp(-windows.decay * after)
    plain = windows.decay == 0
    force = hits.force if plain and windows.force_length is None else level
    motion = hits.motion if plain else hits.motion - _offset_before(hits)
    return replace(
        hits,
        force=force * decay * force_window(after, windows.force_length),
        motion=motion if plain else motion * decay[:, None, :],
    )


def _offset_before(hits: Hits) -> FloatArray:
    """Return the offset of each response as it is before the hit, shape (n_hits, n_responses, 1)."""
    offset = np.zeros((*hits.motion.shape[:2], 1))
    for number, wave in enumerate(upright(hits.force)):
        first, last = pulse_ends(wave)
        quiet = hits.motion[number, :, : max(first - 2 * (last - first + 1), 0)]
        count = quiet.shape[-1]
        if count >= QUIET:
            mean = quiet.mean(axis=-1, dtype=np.float64)
            above_noise = np.abs(mean) > 3 * quiet.std(axis=-1, dtype=np.float64) / np.sqrt(count)
            offset[number, :, 0] = np.where(above_noise, mean, 0.0)
    return offset


def state_window(
    test: HammerTest,
    *,
    decay: float,
    on: Literal["both", "responses"] | None = None,
    origin: float = 0.0,
) -> tuple[HammerTest, tuple[str, ...]]:
    """Return the test with an exponential window stated that was applied before the records were stored.

    If force x(t) and response y(t) were both multiplied by exp(-d (t - t0)), their ratio is H(s + d)
    whatever t0 is, and nothing needs to be done but to hand d on. If the response alone was, the ratio is
    H(s + d) exp(-d (t_hit - t0)) with the hit's own time, which scatters from hit to hit; then the force is
    given the same window here, which makes the ratio H(s + d) exactly.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored, with no decay stated yet.
    decay : float
        Decay rate of the window [1/s].
    on : {"both", "responses"}, optional
        Which records were windowed; left out: by the noise of the force, see `windowed_records`.
    origin : float
        Time after the start of the record at which a window on the responses alone was 1 [s].

    Returns
    -------
    HammerTest
        Records with force and responses windowed alike, and ``decay`` stated.
    tuple of str
        What was found and done.

    Raises
    ------
    InputError
        If the decay is negative, or one is stated already.
    """
    if decay < 0 or not np.isfinite(decay):
        raise InputError(f"{test.source}: the decay of a window is {decay:g} 1/s; give a rate of 0 or above")
    if test.decay and decay:
        raise InputError(f"{test.source}: an exponential window of {test.decay:g} 1/s is stated already")
    if decay == 0:
        return test, ()
    messages: tuple[str, ...] = ()
    if on is None:
        on, messages = windowed_records(test, decay)
    if on == "both":
        return replace(test, decay=decay), messages
    window = np.exp(-decay * (np.arange(test.samples) / test.rate - origin))
    points = tuple(replace(p, force=without_drift(p.force) * window) for p in test.points)
    return replace(test, points=points, decay=decay), messages


def force_noise_decay(test: HammerTest) -> float | None:
    """Return the rate at which the noise of the force decays after the pulse [1/s]; None if there is too little noise.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    found = noise_decay(test, "after")
    return None if found is None else found.rate


def unstated_window(test: HammerTest) -> float | None:
    """Return the decay of an exponential window that is not stated, as the force records have it [1/s].

    None if the test states a decay, or the noise decays no more than chance lets it seem to: the limit is
    Student's t of probability 1e-5 times the standard error, and 0.5 1/s. Where there are tops of clipped pulses that
    fall at that rate, theirs is the more exact one; where there is no noise, they alone determine it.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    if test.decay:
        return None
    noise = noise_decay(test, "after")
    forces = [force for point in test.points for force in point.force if np.isfinite(force).all()]
    if noise is None:
        return top_decay(forces, test.rate)
    rate = noise.rate
    limit = max(3.0, -float(special.stdtrit(noise.freedom, 1e-5))) * noise.error
    if rate > max(0.5, limit):
        return top_decay(forces, test.rate, about=(rate - limit, rate + limit)) or rate
    slanted = top_decay(forces, test.rate)
    return slanted if slanted is not None and abs(slanted - rate) < limit else None


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
