"""Long records with many hits, cut into one record a hit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.hits.checks import noise_level, pulse_width, pushes, upright
from acquisition.hits.hammer import HammerTest, Hits

BOUNCE = 0.2
"""Hits closer than this are one hit with a bounce, a double hit, wherever the spacing of the others allows [s]."""
COMPARABLE = 0.3  # of the largest force: what counts as a hit when records are judged long or not
LOW, HIGH = 0.1, 10.0  # trigger: part of the usual peak, and multiple of the noise, at least
NEAR_SPACING = 0.5  # of the usual spacing, or of a record: hits closer than this are left out
USED_UP = 0.98  # of the shortest usual spacing
CROWDED = 0.1
"""Part of a record within which hits are one hit with a bounce, where none are `BOUNCE` apart: hits of a long record
fill it, a bounce follows at once. Doubled, five quick hits in a short record are no longer split [-]."""

ELSE = "record one hit at a time, or cut with modalkit.split_hits(test, duration=..., pre=...) in Python"
"""What to do about records that cannot be cut out as proposed."""


@dataclass(frozen=True)
class _Found:
    """Hits of one long record: where the trigger was crossed and what was recorded there."""

    point: int
    record: int
    starts: tuple[int, ...]


def holds_several_hits(test: HammerTest) -> bool:
    """Return whether records hold several well-separated hits each, so that `split_hits` is called for.

    The usual record must hold at least two hits of comparable force. A double hit does not make a record long, nor
    does the ringing of a sharp anti-alias filter, however high its lobes: a hammer only pushes, while ringing swings
    about zero from the pulse on, so its lobes are gone once the force is averaged over a period of it.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    """
    counts = []
    for point in test.points:
        for wave in upright(point.force):
            count = _count(wave, test.rate)
            counts.append(_count(*pushes(wave, test.rate)) if count > 1 else count)
    return bool(np.median(counts) >= 2)


def _count(wave: FloatArray, rate: float) -> int:
    """Return how many hits of comparable force a record holds."""
    level = max(COMPARABLE * float(wave.max()), HIGH * noise_level(wave))
    return len(_groups(wave, level, rate))


def propose_trigger(test: HammerTest) -> float:
    """Return a trigger level: a tenth of the usual peak force, and well above the noise [N].

    Parameters
    ----------
    test : HammerTest
        Long records.
    """
    waves = [wave for point in test.points for wave in upright(point.force)]
    noise = max(noise_level(wave) for wave in waves)
    peaks: list[float] = []
    for wave in waves:
        level = max(0.03 * float(wave.max()), HIGH * noise)
        starts = _groups(wave, level, test.rate)
        stops = [*starts[1:], len(wave)]
        peaks += [float(wave[a:b].max()) for a, b in zip(starts, stops, strict=True)]
    if not peaks:
        raise InputError(
            f"{test.source}: no hit stands out of the noise of {noise:.2g} N in records that seem to hold several "
            "hits; check the force channel, or cut them with modalkit.split_hits(test, trigger=...) in Python"
        )
    strong = [p for p in peaks if p > 0.2 * max(peaks)]
    return max(LOW * float(np.median(strong)), HIGH * noise)


def split_hits(
    test: HammerTest, *, trigger: float | None = None, pre: float | None = None, duration: float | None = None
) -> tuple[HammerTest, tuple[str, ...]]:
    """Cut long records into one record for every hit.

    Parameters
    ----------
    test : HammerTest
        Long records; several at a point are taken one after the other.
    trigger : float, optional
        Force at which a hit begins [N]; left out: `propose_trigger`.
    pre : float, optional
        Time kept before the trigger [s]; left out: a fiftieth of the record, at least five pulse widths.
    duration : float, optional
        Length of the records cut out [s]; left out: as long as the spacing of the hits allows.

    Returns
    -------
    HammerTest
        One record a hit. A bounce shortly after a hit stays in its record, where `judge_hits` finds it.
    tuple of str
        What was done, and which hits were left out because others, or the ends, are too close.

    Raises
    ------
    InputError
        If nothing reaches the trigger, no hit can be cut out whole, or the records were already windowed.
    """
    if test.decay:
        raise InputError(
            f"{test.source}: each record seems to hold several hits, and an exponential window of {test.decay:g} 1/s "
            "weakened the later ones; give the records without the window, record one hit at a time, or, if there was "
            "no window, remove it from --decay, exponential_window or the ID lines"
        )
    level = propose_trigger(test) if trigger is None else float(trigger)
    found, width = _find(test, level)
    length = _length(test, found) if duration is None else round(duration * test.rate)
    lead = max(round(0.02 * length), int(np.ceil(5 * width))) if pre is None else round(pre * test.rate)
    if not 0 <= lead < length <= test.samples:
        raise InputError(_too_short(test, lead, length, duration is None))
    kept: dict[int, list[tuple[int, int]]] = {}
    messages = []
    for f in found:
        fits, complaints = _fitting(f, lead, length, test)
        messages += complaints
        kept.setdefault(f.point, []).extend((f.record, start - lead) for start in fits)
    points = tuple(_cut(test.points[k], rows, length) for k, rows in kept.items() if rows)
    if not points:
        raise InputError(
            f"{test.source}: no hit is followed by {length / test.rate:g} s without the next hit or the end of the "
            f"record; {ELSE}"
        )
    count = sum(p.count for p in points)
    how = (
        f"{test.source}: long records were split into {count} hits of {length / test.rate:.4g} s "
        f"(trigger {level:.3g} N, {lead / test.rate:.3g} s before it)"
    )
    return replace(test, points=points), (how, *messages)


def _too_short(test: HammerTest, lead: int, length: int, proposed: bool) -> str:
    """State why records of this length, with this lead before the trigger, cannot be cut out [samples]."""
    span, before = length / test.rate, lead / test.rate
    if length > test.samples:
        return (
            f"{test.source}: records of {span:g} s do not fit into the {test.duration:g} s recorded; {ELSE}"
        )
    if proposed:
        return (
            f"{test.source}: the hits follow one another after {span:g} s, which leaves no room for the {before:g} s "
            f"kept before each; {ELSE}"
        )
    return f"{test.source}: records of {span:g} s have no room for {before:g} s before the trigger; {ELSE}"


def _groups(wave: FloatArray, level: float, rate: float) -> list[int]:
    """Return where hits begin: crossings of a level, those of one hit and its bounces together [samples]."""
    above = wave >= level
    starts = np.flatnonzero(above & ~np.concatenate([[False], above[:-1]]))
    if len(starts) < 2:
        return [int(s) for s in starts]
    gaps = np.diff(starts) / rate
    separate = gaps[gaps >= BOUNCE]
    near = max(0.1 * float(gaps.max()), CROWDED * len(wave) / rate)
    together = min(BOUNCE, 0.3 * float(np.median(separate)) if len(separate) else near)
    return [int(s) for s in starts[np.concatenate([[True], gaps >= together])]]


def _find(test: HammerTest, level: float) -> tuple[list[_Found], float]:
    """Return the hits of every record and the usual width of a pulse [samples]."""
    found, widths = [], []
    for k, point in enumerate(test.points):
        for j, wave in enumerate(upright(point.force)):
            starts = _groups(wave, level, test.rate)
            widths.append(pulse_width(wave, 1.0))
            found.append(_Found(k, j, tuple(starts)))
    if not any(f.starts for f in found):
        top = max(float(upright(p.force).max()) for p in test.points)
        raise InputError(
            f"{test.source}: no force reaches the trigger of {level:g} N; the largest is {top:g} N: "
            "give a lower trigger"
        )
    return found, float(np.median(widths))


def _length(test: HammerTest, found: list[_Found]) -> int:
    """Return the length of record that the spacing of the hits allows [samples]."""
    gaps = np.concatenate([np.diff(np.asarray(f.starts, dtype=np.float64)) for f in found])
    if len(gaps) == 0:
        return int(test.samples // 2)
    normal = gaps[gaps >= NEAR_SPACING * np.median(gaps)]
    return int(USED_UP * normal.min())


def _fitting(f: _Found, lead: int, length: int, test: HammerTest) -> tuple[list[int], list[str]]:
    """Return the hits of a record that can be cut out whole and alone, and a word on every other."""
    where = f"{test.source}: point {test.points[f.point].reference}"
    fits, complaints = [], []
    for n, start in enumerate(f.starts):
        name = f"{where}, hit at {start / test.rate:.4g} s"
        first, last = start - lead, start - lead + length
        if first < 0 or last > test.samples:
            side = "start" if first < 0 else "end"
            complaints.append(f"{name} is too close to the {side} of the record and was left out")
        elif n + 1 < len(f.starts) and f.starts[n + 1] < last:
            gap = (f.starts[n + 1] - start) / test.rate
            complaints.append(f"{name} was left out: the next hit follows after {gap:.3g} s")
        elif n and start - f.starts[n - 1] < NEAR_SPACING * length:
            gap = (start - f.starts[n - 1]) / test.rate
            complaints.append(f"{name} was left out: the hit {gap:.3g} s before it still rings")
        else:
            fits.append(start)
    return fits, complaints


def _cut(hits: Hits, rows: list[tuple[int, int]], length: int) -> Hits:
    index = [(record, slice(start, start + length)) for record, start in rows]
    return replace(
        hits,
        force=np.stack([hits.force[record, part] for record, part in index]),
        motion=np.stack([hits.motion[record, :, part] for record, part in index]),
    )
