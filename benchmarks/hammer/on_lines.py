"""FRFs that come without hits: averaged over windowed blocks, or on lines as far apart as peaks are wide."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from acquisition import FrfSet
from acquisition.synthetic import ModalSystem
from hammer.plain import beam_test
from hammer.setups import Setup

BLOCKS = 60
Made = tuple[FrfSet, NDArray[np.bool_]]


def averaged(
    system: ModalSystem,
    true: NDArray[np.complex128],
    band: tuple[float, float],
    rng: np.random.Generator,
    *,
    order: int = 0,
    coherent: bool = False,
) -> Made:
    """Average FRFs of a random force over half-overlapping blocks with a Hann window.

    The middle mode's half-power band is one to three lines wide. Of some order, a filter makes the force weak from 0.6
    of the band's end on, and noise of the response is ten times as strong; coherence may go with the FRFs.
    """
    width = float(np.median(-true.real)) / np.pi
    duration = float(rng.uniform(1.0, 3.0)) / width
    samples = int(2 ** np.ceil(np.log2(2.56 * band[1] * duration)))
    rate = samples / duration
    length = samples * (BLOCKS + 4)  # the first blocks wait for the steady state
    s = 2j * np.pi * np.fft.rfftfreq(length, 1 / rate)
    force = np.fft.rfft(rng.standard_normal(length)) * (np.abs(s) < np.pi * rate)
    if order:
        force /= np.sqrt(1 + (np.abs(s) / (2 * np.pi * 0.6 * band[1])) ** (2 * order))
    window = np.hanning(samples + 1)[:-1]
    kept = slice(max(1, int(np.ceil(band[0] * duration))), int(band[1] * duration) + 1)

    def spectra(line: NDArray[np.complex128], noise: float) -> NDArray[np.complex128]:
        wave = np.fft.irfft(line, length)
        wave = wave + noise * np.std(wave) * rng.standard_normal(length)
        starts = np.arange(4 * samples, length - samples + 1, samples // 2)
        return np.array([np.fft.rfft(window * wave[a : a + samples])[kept] for a in starts])

    push, points, coherence = spectra(force, 0.0), [], []
    power = np.sum(np.abs(push) ** 2, axis=0)
    for point in range(len(system.points)):
        h = system.receptance(s[1:], point)[0] * s[1:] ** 2
        motion = spectra(np.append(0.0, h) * force, 1e-2 if order else 1e-3)
        points.append(np.sum(motion * push.conj(), axis=0) / power)
        coherence.append(np.abs(points[-1]) ** 2 * power / np.sum(np.abs(motion) ** 2, axis=0))
    lines = np.arange(kept.start, kept.stop) / duration
    known = np.array(coherence) if coherent else None
    frfs = FrfSet(
        lines, np.array(points), (system.responses[0],) * len(points), system.points, coherence=known
    )
    return frfs, _above(system, 3.0 / duration, band)


def coarse(
    system: ModalSystem, true: NDArray[np.complex128], band: tuple[float, float], rng: np.random.Generator
) -> Made:
    """Sample FRFs on lines 0.5 to 2 half-power widths apart, 0.3 to 1 % noise, every other set smoothed."""
    df = float(rng.uniform(0.5, 2.0)) * float(np.median(-true.real)) / np.pi
    df = max(df, band[1] / 400)
    lines = np.arange(max(1, np.ceil(band[0] / df)), band[1] / df) * df
    wide = np.concatenate([[lines[0] - df + 1e-3 * df], lines, [lines[-1] + df]])
    s = 2j * np.pi * wide
    values = np.array([(system.receptance(s, j) * s**2)[0] for j in range(len(system.points))])
    smooth = 0.25 * values[:, :-2] + 0.5 * values[:, 1:-1] + 0.25 * values[:, 2:]
    values = smooth if rng.random() < 0.5 else values[:, 1:-1]
    size = np.sqrt(np.mean(np.abs(values) ** 2, axis=1, keepdims=True) / 2) * 10 ** rng.uniform(-2.5, -2.0)
    noise = rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)
    frfs = FrfSet(lines, values + size * noise, (system.responses[0],) * len(values), system.points)
    peak = np.abs(system.residues[0]) * np.abs(system.poles) ** 2 / (np.pi * df - system.poles.real)
    return frfs, _above(system, 2 * df, band) & (np.median(peak, axis=0) > 5 * float(np.median(size)))


def _above(system: ModalSystem, margin: float, band: tuple[float, float]) -> NDArray[np.bool_]:
    hertz = np.abs(system.poles) / (2 * np.pi)
    return np.asarray((hertz > band[0] + margin) & (hertz < band[1] - margin))


def averaged_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose FRFs are averaged over windowed blocks."""
    return replace(beam_test(rng), without_hits=averaged)


def fading_test(rng: np.random.Generator) -> Setup:
    """Draw the same with a force that gets weak along the lines; every other set has coherence."""
    order, coherent = int(rng.choice([3, 4])), bool(rng.random() < 0.5)
    return replace(beam_test(rng), without_hits=partial(averaged, order=order, coherent=coherent))


def coarse_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose FRFs have few lines."""
    return replace(beam_test(rng), without_hits=coarse)
