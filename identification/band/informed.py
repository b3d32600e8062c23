"""Where in a band the FRFs carry information: not where the force, or the filter before the converter, left none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.frfs.estimators import kept_hits
from acquisition.frfs.frf import FrfSet
from acquisition.hits.checks import noise_level, upright
from acquisition.hits.hammer import HammerTest
from acquisition.hits.verdicts import HitVerdict
from acquisition.warned import Consequential
from identification.band.phases import noise_lines

WEAK, FILTERED = 1e-2, 1e-4
"""Power of the force: 20 dB under its largest, lines without coherence count as lost; 40 dB under what it is just
below rate / 2.56, all lines above do: there the anti-alias filter falls, and what is folded back from beyond is of a
size with them. Ten times as much: good lines are lost; a tenth: folded and empty ones are taken for data [-]."""

LOST = 0.5
"""Coherence, freed of what chance gives few hits, under which more of a response is noise than force. Doubled, only
perfect lines would count [-]."""

ABOVE_NOISE = 10.0
"""Power of the force over that of its noise, where single hits give no coherence: H1 is low by a tenth there. Doubled,
the band ends sooner [-]."""

ABOUT = 17
"""Lines over which force and coherence are averaged: single lines scatter. Doubled, edges are found half as sharply."""

PASSED = 2.56
"""Sampling rate over the highest frequency that anti-alias filters pass, as analysers have it. Doubled, half of their
lines count as filtered [-]."""

SOME = 0.02
"""Part of the band that may be lost without a word [-]."""

Judged = tuple[HammerTest, Sequence[HitVerdict]]


def informed_band(
    frfs: FrfSet, tests: Sequence[Judged], band: tuple[float, float] | None
) -> tuple[tuple[float, float] | None, str | None]:
    """Return the part of a band in which the FRFs carry information, and what to say where it is not all of it.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of a test.
    tests : sequence of (HammerTest, verdicts)
        The hits they were made of; empty where they were read.
    band : tuple of float, optional
        Band asked for; None for all lines, as in the answer [Hz].
    """
    asked, band = band, band or (float(frfs.frequency[0]), float(frfs.frequency[-1]))
    inside = (frfs.frequency >= band[0]) & (frfs.frequency <= band[1]) & (frfs.frequency > 0)
    lost, why, advice = _lost(frfs, tests, inside)
    if lost is None or (lost & inside).sum() <= max(SOME * inside.sum(), ABOUT):
        return asked, None
    runs = _runs(inside & ~lost)
    first, last = runs[0].tolist() if len(runs) else (0, 0)
    if last - first < 2 * ABOUT:
        return asked, Consequential(
            f"almost no spectral line from {band[0]:.4g} to {band[1]:.4g} Hz carries information: the force is too "
            "weak there; do not trust modes in this band"
        )
    low = band[0] if not (lost & inside)[:first].any() else float(frfs.frequency[first])
    high = band[1] if not (lost & inside)[last:].any() else float(frfs.frequency[last])
    again = [
        f"from {frfs.frequency[a]:.4g} to {frfs.frequency[b]:.4g} Hz"
        for a, b in runs[1:]
        if b - a >= 2 * ABOUT
    ]
    whole = f"from {band[0]:.4g} to {band[1]:.4g} Hz"
    instead = f"the lines go {whole}" if asked is None else f"not {whole} as asked"
    return (low, high), Consequential(
        f"modes are sought from {low:.4g} to {high:.4g} Hz only, {instead}: {why} in the rest; {advice}, or name "
        "a mode there with add, to go further"
        + (
            f"; {', '.join(again)} the FRFs carry information again: identify that band separately"
            if again
            else ""
        )
    )


def best_coherence(frfs: FrfSet) -> FloatArray | None:
    """Return the coherence of the best FRF about each line, without what chance gives, (n_lines,) [-]."""
    if frfs.coherence is None:
        return None
    count = 1 if frfs.averages is None else int(frfs.averages.min())
    chance = 1.0 / count if count > 1 else 0.0
    mean = uniform_filter1d(frfs.coherence, ABOUT, axis=1, mode="nearest").max(axis=0)
    return np.asarray((mean - chance) / (1.0 - chance), dtype=np.float64)


def _lost(frfs: FrfSet, tests: Sequence[Judged], inside: BoolArray) -> tuple[BoolArray | None, str, str]:
    """Return the lines that carry no information, None where that cannot be determined; why, and what to do."""
    coherent, advice = best_coherence(frfs), "hit with a harder tip, sample faster"
    if tests:
        why = "the force is too weak, or the anti-aliasing filter removes too much,"
        return _lost_to_force(frfs, tests, coherent), why, advice
    if coherent is not None:
        return _lost_at_the_end(coherent >= LOST, inside), "the coherence is lost", advice
    good = np.zeros(len(inside), dtype=np.bool_)
    good[inside] = ~noise_lines(frfs.values[:, inside])
    why = "the phases of nearly all FRFs are random"
    return _lost_at_the_end(good, inside), why, "hit so that the force reaches higher frequencies"


def _lost_to_force(frfs: FrfSet, tests: Sequence[Judged], coherent: FloatArray | None) -> BoolArray | None:
    """Return the lines at which no point was hit with force enough."""
    parts = [
        _of_test(test, verdicts, frfs.frequency, coherent)
        for test, verdicts in tests
        if any(v.used for v in verdicts) or not verdicts
    ]
    return np.asarray(np.all(parts, axis=0)) if parts else None


def _of_test(
    test: HammerTest, verdicts: Sequence[HitVerdict], frequency: FloatArray, coherent: FloatArray | None
) -> BoolArray:
    power, noise = np.zeros(test.samples // 2 + 1), 0.0
    for hits, keep in kept_hits(test, verdicts):
        waves = upright(np.asarray(hits.force[keep], dtype=np.float64))
        power += (np.abs(np.fft.rfft(waves, axis=-1)) ** 2).sum(axis=0)
        noise += sum(noise_level(wave) ** 2 for wave in waves) * test.samples
    smooth = np.maximum(uniform_filter1d(power[1:], ABOUT, mode="nearest") - noise, 0.0)
    lines = np.fft.rfftfreq(test.samples, 1 / test.rate)[1:]
    level = np.interp(frequency, lines, smooth) / smooth.max()
    weak = level * smooth.max() < ABOVE_NOISE * noise if coherent is None else coherent < LOST
    corner = test.rate / PASSED
    passed = level[(frequency > 0.9 * corner) & (frequency <= corner)].max(initial=0.0)
    return np.asarray(((level < WEAK) & weak) | ((level < FILTERED * passed) & (frequency > corner)))


def _lost_at_the_end(good: BoolArray, inside: BoolArray) -> BoolArray | None:
    """Return the lines at the upper end of a band from which nothing good comes back; None where nothing is good."""
    found = np.flatnonzero(inside & good)
    return None if not len(found) else np.asarray(inside & (np.arange(len(inside)) > found[-1]))


def _runs(good: BoolArray) -> IntArray:
    """Return the first and last line of the runs of good ones, the longest first, (n_runs, 2).

    A run beyond a hole is not joined to it: next to a zero of the force modes come out biased, and in it noise does.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(np.int8)))
    runs = edges.reshape(-1, 2) - [0, 1]
    return np.asarray(runs[np.argsort(runs[:, 0] - runs[:, 1], kind="stable")])


def at_cut_edge(
    frequency: FloatArray, within: tuple[float, float], band: tuple[float, float], df: float
) -> list[float]:
    """Return modes on the edge of a band that was cut: what lies beyond it bends the last lines and passes for one.

    Parameters
    ----------
    frequency : (n_modes,) array
        Frequencies found [Hz].
    within, band : tuple of float
        The band as cut, and as asked for [Hz].
    df : float
        Spacing of the lines [Hz].
    """
    low = within[0] + df if within[0] > band[0] else 0.0
    high = within[1] - df if within[1] < band[1] else np.inf
    return [float(f) for f in frequency if not low <= f <= high]
