"""A verdict on every hit, with reasons; whether a hit is used stays the user's decision."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from acquisition.dof import Dof
from acquisition.hits.checks import (
    agreement,
    at_common_limit,
    clipped,
    dead_from,
    dropouts,
    flat_pulse,
    flat_waves,
    force_bands,
    left_at_end,
    noise_level,
    odd_responses,
    pulse_width,
    second_hits,
    upright,
    why_broken,
    without_drift,
)
from acquisition.hits.faults import Fault
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.hits.verdicts import HitVerdict
from acquisition.hits.windows import unstated_window

TOO_WEAK = 0.2  # of the median peak at the point
TOO_STRONG = 4.0  # times the median peak at the point
ODD_WIDTH = 1.5  # times the median width at the point, or a part of it as small
BURIED = 10.0  # times the noise: a peak below it is too weak by itself
UNDECAYED = 0.02  # of the largest stretch of the response
OFFSET = 0.01  # of the peak
AGREEING = 0.8  # mean coherence that two hits at a point reach

REGROWTH = 5.0
"""Most that the decay of an exponential window is taken back in a force record, from its pulse on [-]."""


def judge_hits(test: HammerTest) -> tuple[HitVerdict, ...]:
    """Judge every hit of a test.

    A hit is refused for a record that is too short, not finite or without a force, for a second hit, overload, a
    dead channel, a force that is too weak or far stronger than usual, a pulse of odd length, or a response that the
    other hits at the point do not explain. That the response has not decayed at the end of the record, that a
    record has an offset, that one response of several is dead, or that the only two hits at a point disagree, is
    reported but does not reject the hit.

    Parameters
    ----------
    test : HammerTest
        Raw records.

    Returns
    -------
    tuple of HitVerdict
        In the order of the hits; where a point was hit in several runs, these are numbered through.
    """
    broken = [why_broken(p) for p in test.points]
    sound = [_those(p, [not why for why in whys]) for p, whys in zip(test.points, broken, strict=True)]
    judged = iter(_judge_sound(test, [p for p in sound if p.count]))
    verdicts: list[HitVerdict] = []
    seen: dict[Dof, int] = {}
    for point, whys in zip(test.points, broken, strict=True):
        first = seen.get(point.reference, 0)
        verdicts += [
            replace(next(judged), hit=first + k + 1) if why is None else _unjudged(point, first + k + 1, why)
            for k, why in enumerate(whys)
        ]
        seen[point.reference] = first + point.count
    return tuple(verdicts)


def _those(hits: Hits, wanted: list[bool]) -> Hits:
    return hits if all(wanted) else replace(hits, force=hits.force[wanted], motion=hits.motion[wanted])


def _unjudged(hits: Hits, number: int, why: Fault) -> HitVerdict:
    return HitVerdict(
        point=hits.reference,
        hit=number,
        used=False,
        reasons=(str(why),),
        peak=0.0,
        width=0.0,
        band10=0.0,
        band20=0.0,
        kind=why.kind,
    )


def _judge_sound(whole: HammerTest, points: list[Hits]) -> list[HitVerdict]:
    """Judge hits whose records can be judged; in their order, numbered at each entry of ``points`` alone."""
    if not points:
        return []
    test = replace(whole, points=tuple(points))
    usual = _usual_peaks(test)
    window = test.decay or unstated_window(whole) or 0.0
    level = [_without_window(point, window, test.rate) for point in test.points]
    limits = _at_limits(level)
    return [
        verdict
        for point, flat, over in zip(test.points, level, limits, strict=True)
        for verdict in _judge_point(point, test, usual[point.reference], flat, over)
    ]


def _without_window(hits: Hits, decay: float, rate: float) -> Hits:
    """Return the records as they were before a window of that decay [1/s], in forces as far as their pulses reach.

    They keep their offsets: those that end at a limit are detected by it.
    """
    if not decay:
        return hits
    growth = np.exp(decay * np.arange(hits.force.shape[-1]) / rate)
    level = without_drift(hits.force, fade=decay / rate)
    return replace(hits, force=hits.force * _regrowth(level, growth), motion=hits.motion * growth)


def _regrowth(level: FloatArray, growth: FloatArray) -> FloatArray:
    """Return by how much forces are taken back; ``level`` are the forces without drift."""
    top = np.abs(level).argmax(axis=-1)
    return np.asarray(np.minimum(growth, REGROWTH * growth[top][:, None]))


def _usual_peaks(test: HammerTest) -> dict[Dof, float]:
    """Return for each point the median peak of its forces that stand out of their noise, of all if none does [N].

    Points are not compared with each other: one that is hard to reach is hit softly, and its hits are sound.
    """
    waves: dict[Dof, list[FloatArray]] = {}
    for p in test.points:
        waves.setdefault(p.reference, []).extend(_waves(p, test))
    peaks = {point: np.array([wave.max() for wave in here]) for point, here in waves.items()}
    noise = {point: np.array([noise_level(wave) for wave in here]) for point, here in waves.items()}
    clear = {point: peaks[point] >= BURIED * noise[point] for point in waves}
    return {
        point: float(np.median(peaks[point][clear[point]] if clear[point].any() else peaks[point]))
        for point in waves
    }


def _at_limits(points: list[Hits]) -> list[tuple[BoolArray, BoolArray]]:
    """Return for every point which hits end at the limit of the force channel, and of which response's."""
    force = at_common_limit([wave for p in points for wave in p.force])
    limits = []
    start = 0
    for p in points:
        limits.append((force[start : start + p.count], np.zeros((p.count, len(p.responses)), dtype=np.bool_)))
        start += p.count
    for dof in dict.fromkeys(d for p in points for d in p.responses):
        rows = [(k, p.responses.index(dof)) for k, p in enumerate(points) if dof in p.responses]
        over = at_common_limit([wave for k, row in rows for wave in points[k].motion[:, row]])
        start = 0
        for k, row in rows:
            limits[k][1][:, row] = over[start : start + points[k].count]
            start += points[k].count
    return limits


def _judge_point(
    hits: Hits, test: HammerTest, usual: float, level: Hits, limits: tuple[BoolArray, BoolArray]
) -> list[HitVerdict]:
    """Judge the hits of one entry; ``level`` are their records without any window, stated or not."""
    motion = (level if test.decay else hits).motion
    waves = _waves(hits, test)
    widths = np.array([pulse_width(wave, test.rate) for wave in waves])
    faults = [_force_faults(wave, usual, test.rate) for wave in waves]
    over_force = clipped(level.force, least=2) | limits[0] | np.array([flat_pulse(wave) for wave in waves])
    flat = np.array([[flat_waves(record) for record in records] for records in motion])
    over_motion = clipped(level.motion) | limits[1] | flat
    dead = np.asarray(np.ptp(hits.motion, axis=-1) == 0)
    for number, (over_f, over_m, alive, still) in enumerate(
        zip(over_force, over_motion, dead_from(motion), dropouts(motion), strict=True)
    ):
        faults[number] += _channel_faults(hits, bool(over_f), over_m, alive, still, dead[number])
    bands = [force_bands(w, test.rate) for w in waves]
    still = replace(hits, force=without_drift(hits.force, fade=test.decay / test.rate))
    _add_outliers(still, faults, widths, max(band[1] for band in bands) / test.rate)
    notes = _odd_pair(still, faults, min(band[0] for band in bands) / test.rate)
    return [
        _verdict(
            hits, number, (wave, float(widths[number]), bands[number]), fault, notes.get(number, ()), test
        )
        for number, (wave, fault) in enumerate(zip(waves, faults, strict=True))
    ]


def _waves(hits: Hits, test: HammerTest) -> FloatArray:
    """Return the forces as pulses are judged by: upwards, without drift, and without the window that is stated.

    Whether the force was windowed too is not known: enough is taken back for a second hit, not so much that noise is
    one.
    """
    if not test.decay:
        return upright(hits.force)
    growth = np.exp(test.decay * np.arange(hits.force.shape[-1]) / test.rate)
    level = without_drift(hits.force, fade=test.decay / test.rate)
    return upright(level * _regrowth(level, growth))


def _verdict(
    hits: Hits,
    number: int,
    pulse: tuple[FloatArray, float, tuple[float, float]],
    faults: list[Fault],
    more: tuple[str, ...],
    test: HammerTest,
) -> HitVerdict:
    wave, width, bands = pulse
    notes = [*_notes(hits, number, wave, test), *more]
    return HitVerdict(
        point=hits.reference,
        hit=number + 1,
        used=not faults,
        reasons=(*map(str, faults), *notes),
        peak=float(wave.max()),
        width=width,
        band10=bands[0],
        band20=bands[1],
        kind=faults[0].kind if faults else "",
    )


def _force_faults(wave: FloatArray, usual: float, rate: float) -> list[Fault]:
    faults = []
    doubles = second_hits(wave)
    if doubles:
        place, height = max(doubles, key=lambda d: d[1])
        delay = 1e3 * (place - int(wave.argmax())) / rate
        faults.append(Fault("double hit", f"{100 * height:.0f} % of the peak, {delay:+.1f} ms from it"))
    peak, noise = float(wave.max()), noise_level(wave)
    if peak < TOO_WEAK * usual:
        faults.append(Fault("too weak", f"{peak:.3g} N, the usual peak there is {usual:.3g} N"))
    elif peak < BURIED * noise:
        faults.append(Fault("too weak", f"{peak:.3g} N over noise of {noise:.2g} N"))
    elif peak > TOO_STRONG * usual:
        faults.append(Fault("outlier in level", f"{peak:.3g} N, the usual peak there is {usual:.3g} N"))
    return faults


def _channel_faults(
    hits: Hits,
    over_force: bool,
    over_motion: BoolArray,
    alive: FloatArray,
    still: FloatArray,
    dead: BoolArray,
) -> list[Fault]:
    def named(which: BoolArray) -> str:
        return _named(hits, which)

    faults = [Fault("overload", "the force is clipped, its top is flat")] if over_force else []
    over_motion = over_motion & ~dead
    if dead.all():
        faults.append(Fault("no response", f"{named(dead)} dead, the record is constant"))
    if over_motion.any():
        faults.append(Fault("overload", f"response {named(over_motion)} is clipped, its tops are flat"))
    if (alive < 1).any():
        part = 100 * alive.min()
        faults.append(
            Fault("response cut off", f"after {part:.0f} % of the record at {named(alive < 1)}", " ")
        )
    if (still > 0).any():
        part = 100 * still.max()
        faults.append(
            Fault("response drops out", f"for {part:.1f} % of the record at {named(still > 0)}", " ")
        )
    return faults


def _named(hits: Hits, which: BoolArray) -> str:
    return ", ".join(str(d) for d, yes in zip(hits.responses, which, strict=True) if yes)


def _odd_pair(hits: Hits, faults: list[list[Fault]], band: float) -> dict[int, tuple[str, ...]]:
    """Return a note on both of the only two good hits at a point where they disagree."""
    good = [i for i, fault in enumerate(faults) if not fault]
    if len(good) != 2 or len(faults) != 2:
        return {}
    seen = agreement(hits, good, band)
    if seen >= AGREEING:
        return {}
    note = f"the two hits at this point disagree: coherence {seen:.2f}; hit again to find which is wrong"
    return dict.fromkeys(good, (note,))


def _notes(hits: Hits, number: int, wave: FloatArray, test: HammerTest) -> list[str]:
    """Return what is worth knowing but refuses nothing."""
    notes = []
    force, motion = hits.force[number], hits.motion[number]
    dead = np.asarray(np.ptp(motion, axis=-1) == 0)
    if dead.any() and not dead.all():
        notes.append(f"response channel {_named(hits, dead)} is dead: the record is constant")
    left = float(left_at_end(motion).max())
    if left > UNDECAYED and test.decay == 0:
        notes.append(
            f"response has {100 * left:.0f} % left at the end of the record; identification includes it"
        )
    offset = float(np.median(force))
    if abs(offset) > OFFSET * wave.max():
        notes.append(f"force has an offset of {offset:.3g} N")
    return notes


def _add_outliers(hits: Hits, faults: list[list[Fault]], widths: FloatArray, band: float) -> None:
    """Add a reason to hits that differ from the other good hits at the point."""
    good = [i for i, fault in enumerate(faults) if not fault]
    usual = float(np.median(widths[good])) if good else 0.0
    for i in good if len(good) > 2 else ():
        if not usual / ODD_WIDTH <= widths[i] <= usual * ODD_WIDTH:
            faults[i].append(
                Fault(
                    "outlier in shape",
                    f"the pulse lasts {1e3 * widths[i]:.2g} ms, usually {1e3 * usual:.2g} ms",
                )
            )
    for i, left in odd_responses(hits, [i for i in good if not faults[i]], band).items():
        faults[i].append(
            Fault("outlier", f"the other hits leave {100 * left:.0f} % of the response unexplained")
        )
