"""A verdict on every hit, with reasons; whether a hit is used stays the user's decision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
import scipy.fft

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.hammer import HammerTest, Hits
from acquisition.pulse_checks import (
    clipped,
    dead_from,
    force_bands,
    left_at_end,
    pulse_width,
    second_hits,
    upright,
)

TOO_WEAK = 0.2  # of the median peak of the test
UNDECAYED = 0.02  # of the largest stretch of the response
OUTLIER = 0.05  # of the response's energy that the other hits do not explain


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
        Whether it should be used: the program's proposal.
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

    A hit is refused for a second hit, overload, a dead channel, a force that is too weak, or a response that
    the other hits at the point do not explain. That the response has not decayed at the end of the record, or
    that the force has an offset, is said but refuses nothing.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    """
    peaks = np.concatenate([upright(p.force).max(axis=-1) for p in test.points])
    usual = float(np.median(peaks))
    return tuple(verdict for point in test.points for verdict in _judge_point(point, test, usual))


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


REGROWTH = 5.0
"""Most that the decay of an exponential window is taken back in a force record [-]."""


def _judge_point(hits: Hits, test: HammerTest, usual: float) -> list[HitVerdict]:
    growth = np.exp(test.decay * np.arange(test.samples) / test.rate)
    # whether the force was windowed too is not known: take back enough for a second hit, not so much that noise is one
    force, motion = hits.force * np.minimum(growth, REGROWTH), hits.motion * growth
    waves = upright(force)
    faults = [_force_faults(wave, usual, test.rate) for wave in waves]
    for number, (over_f, over_m, alive) in enumerate(
        zip(clipped(force), clipped(motion), dead_from(motion), strict=True)
    ):
        faults[number] += _channel_faults(hits, bool(over_f), over_m, alive)
    _add_outliers(hits, faults, max(force_bands(w, test.rate)[1] for w in waves) / test.rate)
    verdicts = []
    for number, (wave, fault) in enumerate(zip(waves, faults, strict=True)):
        bands = force_bands(wave, test.rate)
        notes = _notes(force[number], hits.motion[number], wave, test)
        verdicts.append(
            HitVerdict(
                point=hits.reference,
                hit=number + 1,
                used=not fault,
                reasons=(*fault, *notes),
                peak=float(wave.max()),
                width=pulse_width(wave, test.rate),
                band10=bands[0],
                band20=bands[1],
            )
        )
    return verdicts


def _force_faults(wave: FloatArray, usual: float, rate: float) -> list[str]:
    faults = []
    doubles = second_hits(wave)
    if doubles:
        place, height = max(doubles, key=lambda d: d[1])
        delay = 1e3 * (place - int(wave.argmax())) / rate
        faults.append(f"double hit: {100 * height:.0f} % of the peak, {delay:+.1f} ms from it")
    if wave.max() < TOO_WEAK * usual:
        faults.append(f"too weak: {wave.max():.3g} N, the usual peak is {usual:.3g} N")
    return faults


def _channel_faults(hits: Hits, over_force: bool, over_motion: FloatArray, alive: FloatArray) -> list[str]:
    faults = ["overload: the force has a flat top"] if over_force else []
    overloaded = [str(d) for d, over in zip(hits.responses, over_motion, strict=True) if over]
    if overloaded:
        faults.append(f"overload: flat tops at response {', '.join(overloaded)}")
    dead = [str(d) for d, part in zip(hits.responses, alive, strict=True) if part < 1]
    if dead:
        faults.append(f"response cut off after {100 * alive.min():.0f} % of the record at {', '.join(dead)}")
    return faults


def _notes(force: FloatArray, motion: FloatArray, wave: FloatArray, test: HammerTest) -> list[str]:
    """Return what is worth knowing but refuses nothing."""
    notes = []
    left = float(left_at_end(motion).max())
    if left > UNDECAYED and test.decay == 0:
        notes.append(f"response has {100 * left:.0f} % left at the end: longer record or exponential window")
    offset = float(np.median(force))
    if abs(offset) > 0.05 * wave.max():
        notes.append(f"force has an offset of {offset:.3g} N")
    return notes


def _add_outliers(hits: Hits, faults: list[list[str]], band: float) -> None:
    """Add a reason to hits whose response the other good hits do not explain.

    A bad hit among n pollutes the average that the others are compared with, so its own misfit stands out by
    (n - 1)^2 at most; a hit stands out if it reaches well over half of that, or nine times the others.
    """
    good = [i for i, fault in enumerate(faults) if not fault]
    if len(good) < 3:
        return
    misfit = unexplained(hits, good, band)
    ratio = min(9.0, 0.6 * (len(good) - 1) ** 2)
    for i, value in zip(good, misfit, strict=True):
        others = float(np.median([m for j, m in zip(good, misfit, strict=True) if j != i]))
        if value > max(OUTLIER, ratio * others):
            faults[i].append(f"outlier: the other hits leave {100 * value:.0f} % of the response unexplained")


def unexplained(hits: Hits, good: Sequence[int], band: float) -> FloatArray:
    """Return what H1 over the other hits leaves of each response's energy, shape (len(good),) [-].

    Parameters
    ----------
    hits : Hits
        Hits at one point.
    good : sequence of int
        Which hits are compared.
    band : float
        Upper end of the lines used, relative to the sampling rate [-].
    """
    lines = slice(1, max(3, int(band * hits.force.shape[-1])))
    force = scipy.fft.rfft(hits.force[list(good)], axis=-1)[:, lines]
    motion = scipy.fft.rfft(hits.motion[list(good)], axis=-1)[..., lines]
    cross, power = motion * force.conj()[:, None], np.abs(force) ** 2
    rest = np.maximum(power.sum(axis=0) - power, np.finfo(float).tiny)
    predicted = (cross.sum(axis=0) - cross) / rest[:, None] * force[:, None]
    energy = np.maximum((np.abs(motion) ** 2).sum(axis=-1), np.finfo(float).tiny)
    left = (np.abs(motion - predicted) ** 2).sum(axis=-1) / energy
    return np.asarray(left.mean(axis=-1), dtype=np.float64)
