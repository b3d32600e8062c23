"""A verdict on every hit, with reasons; whether a hit is used stays the user's decision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from acquisition.arrays import BoolArray, FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.hammer import HammerTest, Hits
from acquisition.hit_checks import (
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
)

TOO_WEAK = 0.2  # of the median peak of the test
TOO_STRONG = 4.0  # times the median peak of the test
ODD_WIDTH = 1.5  # times the median width at the point, or a part of it as small
BURIED = 10.0  # times the noise: a peak below it is too weak by itself
UNDECAYED = 0.02  # of the largest stretch of the response
OFFSET = 0.01  # of the peak

REGROWTH = 5.0
"""Most that the decay of an exponential window is taken back in a force record [-]."""


@dataclass(frozen=True)
class HitVerdict:
    """What is thought of a hit.

    Parameters
    ----------
    point : Dof
        Where the hammer hit.
    hit : int
        Number of the hit at this point, from 1.
    used : bool
        Whether it should be used: the program's proposal, or the user's decision (see `decide`).
    reasons : tuple of str
        Why not, and what else to know of it.
    peak : float
        Largest force [N].
    width : float
        Length of the pulse above a tenth of its peak [s].
    band10, band20 : float
        Frequencies at which the force spectrum is 10 and 20 dB down [Hz].
    """

    point: Dof
    hit: int
    used: bool
    reasons: tuple[str, ...]
    peak: float
    width: float
    band10: float
    band20: float


def judge_hits(test: HammerTest) -> tuple[HitVerdict, ...]:
    """Judge every hit of a test.

    A hit is refused for a second hit, overload, a dead channel, a force that is too weak or far stronger than
    usual, a pulse of odd length, or a response that the other hits at the point do not explain. That the
    response has not decayed at the end of the record, or that a record has an offset, is said but refuses
    nothing.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    """
    peaks = np.concatenate([upright(p.force).max(axis=-1) for p in test.points])
    usual = float(np.median(peaks))
    limits = _at_limits(test)
    return tuple(
        verdict
        for point, over in zip(test.points, limits, strict=True)
        for verdict in _judge_point(point, test, usual, over)
    )


def decide(
    verdicts: Iterable[HitVerdict],
    *,
    use: Iterable[tuple[Dof | str, int]] = (),
    leave: Iterable[tuple[Dof | str, int]] = (),
) -> tuple[HitVerdict, ...]:
    """Return the verdicts with the user's decisions in place of the program's proposals.

    Parameters
    ----------
    verdicts : iterable of HitVerdict
        The proposals.
    use, leave : iterables of (Dof or str, int)
        Hits to use or to leave out whatever was proposed: the point, as a degree of freedom or as printed
        (``"12+Z"``), and the number of the hit at it, from 1. The reasons stay listed.

    Raises
    ------
    InputError
        If there is no such hit, or one is named in both lists.
    """
    proposals = tuple(verdicts)
    known = {(str(v.point), v.hit) for v in proposals}
    wanted, unwanted = _named(use, known), _named(leave, known)
    if wanted & unwanted:
        point, hit = min(wanted & unwanted)
        raise InputError(f"hit {hit} at {point} is named both to use and to leave out; decide for one")
    decided = []
    for v in proposals:
        name = (str(v.point), v.hit)
        if name in wanted:
            reasons = v.reasons if v.used else (*v.reasons, "used by the user's decision")
            decided.append(replace(v, used=True, reasons=reasons))
        elif name in unwanted:
            decided.append(replace(v, used=False, reasons=(*v.reasons, "left out by the user")))
        else:
            decided.append(v)
    return tuple(decided)


def _named(hits: Iterable[tuple[Dof | str, int]], known: set[tuple[str, int]]) -> set[tuple[str, int]]:
    names = {(str(point).strip().upper(), int(hit)) for point, hit in hits}
    for point, hit in sorted(names - known):
        numbers = sorted(h for p, h in known if p == point)
        points = ", ".join(sorted({p for p, _ in known})[:8])
        there = f"hits there: 1 to {numbers[-1]}" if numbers else f"points hit are {points}"
        raise InputError(f"there is no hit {hit} at {point}; {there}; write a point like 12+Z or 3-X")
    return names


def hits_table(verdicts: Iterable[HitVerdict]) -> pd.DataFrame:
    """Return one row per hit: point, used, reasons, peak [N], width [ms], 10 and 20 dB bands [Hz]."""
    return pd.DataFrame(
        [
            [str(v.point), v.hit, v.used, "; ".join(v.reasons), v.peak, 1e3 * v.width, v.band10, v.band20]
            for v in verdicts
        ],
        columns=[
            "point",
            "hit",
            "used",
            "reasons",
            "peak [N]",
            "width [ms]",
            "band 10 dB [Hz]",
            "band 20 dB [Hz]",
        ],
    )


def rejected_points(verdicts: Sequence[HitVerdict]) -> tuple[Dof, ...]:
    """Return the points at which no hit is used."""
    used = {v.point for v in verdicts if v.used}
    return tuple(dict.fromkeys(v.point for v in verdicts if v.point not in used))


def _at_limits(test: HammerTest) -> list[tuple[BoolArray, BoolArray]]:
    """Return for every point which hits end at the limit of the force channel, and of which response's."""
    force = at_common_limit([wave for p in test.points for wave in p.force])
    limits = []
    start = 0
    for p in test.points:
        limits.append((force[start : start + p.count], np.zeros((p.count, len(p.responses)), dtype=np.bool_)))
        start += p.count
    for dof in dict.fromkeys(d for p in test.points for d in p.responses):
        rows = [(k, p.responses.index(dof)) for k, p in enumerate(test.points) if dof in p.responses]
        over = at_common_limit([wave for k, row in rows for wave in test.points[k].motion[:, row]])
        start = 0
        for k, row in rows:
            limits[k][1][:, row] = over[start : start + test.points[k].count]
            start += test.points[k].count
    return limits


def _judge_point(
    hits: Hits, test: HammerTest, usual: float, limits: tuple[BoolArray, BoolArray]
) -> list[HitVerdict]:
    growth = np.exp(test.decay * np.arange(test.samples) / test.rate)
    # whether the force was windowed too is not known: take back enough for a second hit, not so much that noise is one
    force, motion = hits.force * np.minimum(growth, REGROWTH), hits.motion * growth
    waves = upright(force)
    widths = np.array([pulse_width(wave, test.rate) for wave in waves])
    faults = [_force_faults(wave, usual, test.rate) for wave in waves]
    over_force = clipped(force) | limits[0] | np.array([flat_pulse(wave) for wave in waves])
    flat = np.array([[flat_waves(record) for record in records] for records in motion])
    over_motion = clipped(motion) | limits[1] | flat
    for number, (over_f, over_m, alive, still) in enumerate(
        zip(over_force, over_motion, dead_from(motion), dropouts(motion), strict=True)
    ):
        faults[number] += _channel_faults(hits, bool(over_f), over_m, alive, still)
    _add_outliers(hits, faults, widths, max(force_bands(w, test.rate)[1] for w in waves) / test.rate)
    return [
        _verdict(hits, number, wave, fault, test)
        for number, (wave, fault) in enumerate(zip(waves, faults, strict=True))
    ]


def _verdict(hits: Hits, number: int, wave: FloatArray, faults: list[str], test: HammerTest) -> HitVerdict:
    bands = force_bands(wave, test.rate)
    notes = _notes(hits.force[number], hits.motion[number], wave, test)
    return HitVerdict(
        point=hits.reference,
        hit=number + 1,
        used=not faults,
        reasons=(*faults, *notes),
        peak=float(wave.max()),
        width=pulse_width(wave, test.rate),
        band10=bands[0],
        band20=bands[1],
    )


def _force_faults(wave: FloatArray, usual: float, rate: float) -> list[str]:
    faults = []
    doubles = second_hits(wave)
    if doubles:
        place, height = max(doubles, key=lambda d: d[1])
        delay = 1e3 * (place - int(wave.argmax())) / rate
        faults.append(f"double hit: {100 * height:.0f} % of the peak, {delay:+.1f} ms from it")
    peak, noise = float(wave.max()), noise_level(wave)
    if peak < TOO_WEAK * usual:
        faults.append(f"too weak: {peak:.3g} N, the usual peak is {usual:.3g} N")
    elif peak < BURIED * noise:
        faults.append(f"too weak: {peak:.3g} N over noise of {noise:.2g} N")
    elif peak > TOO_STRONG * usual:
        faults.append(f"outlier in level: {peak:.3g} N, the usual peak is {usual:.3g} N")
    return faults


def _channel_faults(
    hits: Hits, over_force: bool, over_motion: BoolArray, alive: FloatArray, still: FloatArray
) -> list[str]:
    def named(which: BoolArray) -> str:
        return ", ".join(str(d) for d, yes in zip(hits.responses, which, strict=True) if yes)

    faults = ["overload: the force has a flat top"] if over_force else []
    if over_motion.any():
        faults.append(f"overload: flat tops at response {named(over_motion)}")
    if (alive < 1).any():
        part = 100 * alive.min()
        faults.append(f"response cut off after {part:.0f} % of the record at {named(alive < 1)}")
    if (still > 0).any():
        faults.append(f"response drops out for {100 * still.max():.1f} % of the record at {named(still > 0)}")
    return faults


def _notes(force: FloatArray, motion: FloatArray, wave: FloatArray, test: HammerTest) -> list[str]:
    """Return what is worth knowing but refuses nothing."""
    notes = []
    left = float(left_at_end(motion).max())
    if left > UNDECAYED and test.decay == 0:
        notes.append(f"response has {100 * left:.0f} % left at the end, which identification allows for")
    offset = float(np.median(force))
    if abs(offset) > OFFSET * wave.max():
        notes.append(f"force has an offset of {offset:.3g} N")
    return notes


def _add_outliers(hits: Hits, faults: list[list[str]], widths: FloatArray, band: float) -> None:
    """Add a reason to hits that differ from the other good hits at the point."""
    good = [i for i, fault in enumerate(faults) if not fault]
    usual = float(np.median(widths[good])) if good else 0.0
    for i in good if len(good) > 2 else ():
        if not usual / ODD_WIDTH <= widths[i] <= usual * ODD_WIDTH:
            faults[i].append(
                f"outlier in shape: the pulse lasts {1e3 * widths[i]:.2g} ms, usually {1e3 * usual:.2g} ms"
            )
    for i, left in odd_responses(hits, [i for i in good if not faults[i]], band).items():
        faults[i].append(f"outlier: the other hits leave {100 * left:.0f} % of the response unexplained")
