"""Force and exponential windows that leave the amplitude alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import special

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.hits.checks import pulse_ends, top_decay, upright
from acquisition.hits.hammer import HammerTest, Hits

QUIET = 16  # samples before a hit that tell the offset of a response


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
    would become a step, and windowed, a pulse of its own. The offset of a force is its median, that of a
    response its mean before the hit, where there are 16 samples of it and it stands out of their noise.

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
    offset = np.median(hits.force, axis=-1, keepdims=True)
    after = time - time[np.abs(hits.force - offset).argmax(axis=-1)][:, None]
    decay = np.exp(-windows.decay * after)
    plain = windows.decay == 0
    force = hits.force if plain and windows.force_length is None else hits.force - offset
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
        Which records were windowed; left out: told from whether the noise of the force decays, and both where
        the noise does not tell.
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
        on, messages = _above_noise(test, decay)
    if on == "both":
        return replace(test, decay=decay), messages
    window = np.exp(-decay * (np.arange(test.samples) / test.rate - origin))
    points = tuple(
        replace(p, force=(p.force - np.median(p.force, axis=-1, keepdims=True)) * window) for p in test.points
    )
    return replace(test, points=points, decay=decay), messages


def _above_noise(test: HammerTest, decay: float) -> tuple[Literal["both", "responses"], tuple[str, ...]]:
    """Return which records were windowed, as the noise of the force tells, and what to say of it."""
    seen = force_noise_decay(test)
    if seen is None or seen >= 0.5 * decay:
        return "both", ()
    message = (
        f"{test.source}: the noise of the force does not decay, so the window of {decay:g} 1/s was on "
        "the responses alone; the force was given the same window, counted from the start of the records"
    )
    return "responses", (message,)


def force_noise_decay(test: HammerTest) -> float | None:
    """Return the rate at which the noise of the force decays after the pulse [1/s]; None if it does not tell.

    It tells if the noise is there, a millionth of the peak and a few steps of the converter, over 200 samples.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    above_noise = _rates(test)
    return None if above_noise is None else above_noise[0]


def unstated_window(test: HammerTest) -> float | None:
    """Return the decay of an exponential window that nobody stated, as the force records have it [1/s].

    None if the test states a decay, or the noise decays no more than chance lets it seem to: the limit is
    Student's t of probability 1e-5 times the standard error, and 0.5 1/s. Where there are tops of clipped pulses that
    fall at that rate, theirs is the more exact one; where there is no noise, they alone tell.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    if test.decay:
        return None
    noise = _rates(test)
    forces = [force for point in test.points for force in point.force if np.isfinite(force).all()]
    if noise is None:
        return top_decay(forces, test.rate)
    rate, error, freedom = noise
    limit = max(3.0, -float(special.stdtrit(freedom, 1e-5))) * error
    if rate > max(0.5, limit):
        return top_decay(forces, test.rate, about=(rate - limit, rate + limit)) or rate
    slanted = top_decay(forces, test.rate)
    return slanted if slanted is not None and abs(slanted - rate) < limit else None


def _rates(test: HammerTest) -> tuple[float, float, int] | None:
    """Return the mean decay of the noise of all forces [1/s], its standard error, and degrees of freedom."""
    found = [
        one
        for point in test.points
        for wave in upright(point.force)
        if (one := _rate(wave, test.rate)) is not None
    ]
    if not found:
        return None
    rates, spans, squares, freedom = (np.array(column) for column in zip(*found, strict=True))
    share = spans / spans.sum()
    return float(share @ rates), float(np.sqrt(share**2 @ squares)), int(freedom.sum())


def _rate(wave: FloatArray, rate: float) -> tuple[float, float, float, int] | None:
    """Return the decay of the noise of one force [1/s], its weight, squared error and degrees of freedom."""
    first, last = pulse_ends(wave)
    rest = wave[last + 12 * (last - first + 1) :]
    if len(rest) < 200 or not np.isfinite(rest).all():
        return None
    parts = rest[: len(rest) // 10 * 10].reshape(10, -1)
    level = np.sqrt(np.mean((parts - parts.mean(axis=1, keepdims=True)) ** 2, axis=1))
    steps = np.abs(np.diff(rest))
    step = float(steps[steps > 0].min(initial=np.inf))
    if level[0] < 3 * step and level[0] < 1e-3 * wave.max():
        return None
    above_noise = level > max(step, 1e-6 * float(wave.max())) if step < level[0] / 30 else level > 3 * step
    count = int(above_noise.sum())
    if count < 3:
        return None
    time = (np.arange(10) * parts.shape[1] / rate)[above_noise]
    line = np.polyfit(time, np.log(level[above_noise]), 1)
    left = np.log(level[above_noise]) - np.polyval(line, time)
    scatter = max(float(left @ left) / (count - 2), 0.5 / parts.shape[1])
    spread = float(((time - time.mean()) ** 2).sum())
    return -float(line[0]), float(np.ptp(time)) ** 2, scatter / spread, count - 2


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
