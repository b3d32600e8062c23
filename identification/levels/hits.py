"""The levels of the hits of a test: how hard each was, and whether they separate soft from hard."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition import HammerTest, HitVerdict, Windows, estimate_frfs
from acquisition.arrays import FloatArray, IntArray
from acquisition.frfs.estimators import kept_hits
from acquisition.frfs.frf import FrfSet
from acquisition.hits.hammer import Hits

SPAN = 2.0
"""Strongest over weakest hit from which levels are informative [-]."""

LEAST_FREEDOM = 2
"""Fewest degrees of freedom that a slope common to all points leaves."""

ABOUT, FINER = 128, 8
"""Samples about a peak, and how many points there are for each of them when it is sought between samples."""

Judged = tuple[HammerTest, Sequence[HitVerdict]]
"""A test with what was decided on its hits; no verdicts means that all are used."""


@dataclass(frozen=True, eq=False)
class UsedHits:
    """The used hits of one point in one run.

    Parameters
    ----------
    hits : Hits
        All hits of the point in this run.
    numbers : (n_used,) int array
        Which of them are used.
    levels : (n_used,) array
        Largest force of each [N].
    test : HammerTest
        The run they are from.
    """

    hits: Hits
    numbers: IntArray
    levels: FloatArray
    test: HammerTest

    def single_frfs(self, *, windows: Windows | None, band: tuple[float, float]) -> Iterator[FrfSet]:
        """Go through the FRFs of the single hits, X / F at every line of a band [Hz]."""
        for number in self.numbers.tolist():
            one = slice(number, number + 1)
            hit = Hits(self.hits.reference, self.hits.responses, self.hits.force[one], self.hits.motion[one])
            alone = HammerTest(
                self.test.rate, (hit,), self.test.form, self.test.decay, source=self.test.source
            )
            yield estimate_frfs(alone, windows=windows, band=band)


def used_hits(tests: Sequence[Judged]) -> tuple[UsedHits, ...]:
    """Return the used hits of all tests, one entry per point and run.

    Parameters
    ----------
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    """
    entries = []
    for test, verdicts in tests:
        if verdicts and not any(v.used for v in verdicts):
            continue
        for hits, mask in kept_hits(test, verdicts):
            numbers = np.flatnonzero(mask)
            entries.append(UsedHits(hits, numbers, _peaks(hits, numbers), test))
    return tuple(entries)


def _peaks(hits: Hits, numbers: IntArray) -> FloatArray:
    """Return the largest force of each hit, between the samples too: few of them fall on a short pulse [N]."""
    force = np.asarray(hits.force[numbers], dtype=np.float64)
    size = np.abs(force - np.median(force, axis=-1, keepdims=True))
    length = min(ABOUT, size.shape[-1])
    first = np.clip(size.argmax(axis=-1) - length // 2, 0, size.shape[-1] - length)
    pulse = np.take_along_axis(size, first[:, None] + np.arange(length), axis=-1)
    finer = np.fft.irfft(np.fft.rfft(pulse, axis=-1), FINER * length, axis=-1) * FINER
    return np.asarray(np.maximum(finer.max(axis=-1), pulse.max(axis=-1)))


def why_not(entries: Sequence[UsedHits]) -> str | None:
    """Return why the levels of hits show no level dependence, or None if they do."""
    repeated = [e for e in entries if len(e.numbers) > 1]
    spare = sum(len(e.numbers) - 1 for e in repeated) - 1
    if spare < LEAST_FREEDOM:
        return "too few points were hit twice or more: hit each several times, softly and hard"
    levels = np.concatenate([e.levels for e in repeated])
    span = float(levels.max() / max(levels.min(), np.finfo(float).tiny))
    if span < SPAN:
        return (
            f"the used hits span {levels.min():.3g} to {levels.max():.3g} N, 1 : {span:.2g}; to find a level "
            f"dependence, 1 : {SPAN:g} is needed: hit softly and hard at each point"
        )
    return None


def mean_level(entries: Sequence[UsedHits]) -> float:
    """Return the level that averaged FRFs stand for: the mean over points of sum F^3 / sum F^2 [N].

    H1 weighs hits by their power (Ewins, Modal Testing, 2000, section 3.9), so hard hits have the larger weight.
    """
    return float(np.mean([(e.levels**3).sum() / (e.levels**2).sum() for e in entries]))
