"""Random hits with known faults, for the tests of the verdicts and for benchmarks/bench_hits.py.

Pulses, filters and faults are made here with scipy.signal at a raised rate, independently of the synthetic
hammer test of the package.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.signal

from acquisition.dof import Dof
from acquisition.hits.hammer import HammerTest, Hits

OVER = 4
FILTERS = ("butter", "cheby1", "ellip", "bessel", "fir")


@dataclass(frozen=True)
class Setting:
    """One random measuring chain."""

    rate: float
    samples: int
    start: float
    width: float
    shape: str
    noise: float
    offset: float


def setting(rng, *, rate=(2e3, 5e4), width=(1e-3, 6e-3)):
    rate = float(np.exp(rng.uniform(*np.log(rate))))
    return Setting(
        rate=rate,
        samples=int(max(0.4, 600 / rate) * rate),
        start=rng.uniform(0.03, 0.1),
        width=float(rng.uniform(*width)),
        shape=str(rng.choice(["half-sine", "haversine"])),
        noise=float(10 ** rng.uniform(-3, -2)),
        offset=float(rng.uniform(-0.1, 0.1)),
    )


def fine_time(s):
    return np.arange(s.samples * OVER) / (s.rate * OVER)


def pulse(time, width, shape):
    x = np.clip(time / width, 0, 1)
    return np.sin(np.pi * x) ** (1 if shape == "half-sine" else 2) * (x < 1)


def low_pass(rng, wave, s, kind, *, lowest=0.6):
    """Filter as in front of a converter: 4th to 8th order, or linear phase with pre-ringing."""
    kind = str(rng.choice(FILTERS)) if kind == "any" else kind
    fine = s.rate * OVER
    corner = min(max(rng.uniform(0.15, 0.45) * s.rate, lowest / s.width), 0.45 * s.rate)
    order = int(rng.integers(4, 9))
    if kind == "fir":
        taps = scipy.signal.firwin(
            int(6 * fine / corner) | 1, corner, window=str(rng.choice(["boxcar", "hamming"])), fs=fine
        )
        return scipy.signal.fftconvolve(wave, taps, "same")
    designs = {
        "butter": lambda: scipy.signal.butter(order, corner, fs=fine, output="sos"),
        "cheby1": lambda: scipy.signal.cheby1(order, rng.uniform(0.1, 1), corner, fs=fine, output="sos"),
        "ellip": lambda: scipy.signal.ellip(order, 0.5, 80, corner, fs=fine, output="sos"),
        "bessel": lambda: scipy.signal.bessel(order, corner, fs=fine, output="sos"),
    }
    return scipy.signal.sosfilt(designs[kind](), wave)


def force(rng, s, *, second=None, height=None, filtered=None, clip=None, lowest=0.6):
    """Return a force record [N] with the faults asked for; ``second`` is a range of delays in widths."""
    time = fine_time(s) - s.start
    wave = pulse(time, s.width, s.shape)
    if second is not None:
        delay = rng.uniform(*second) * s.width
        delay = float(np.clip(delay, -s.start, time[-1] - 1.5 * s.width))
        size = rng.uniform(0.1, 0.6) if height is None else height
        wave = wave + size * pulse(time - delay, s.width * rng.uniform(0.8, 1.25), s.shape)
    if clip is not None:
        wave = np.minimum(wave, clip)
    if filtered is not None:
        wave = low_pass(rng, wave, s, filtered, lowest=lowest)
    wave = wave[::OVER] / np.abs(wave).max()
    wave = wave + s.offset + s.noise * rng.standard_normal(s.samples)
    return 100 * float(rng.choice([-1, 1])) * wave


def response(rng, s, *, level=1.0, modes=None, over=1):
    """Return a response [m/s^2], if asked for at a raised rate: free decay of a few modes from the hit on."""
    time = np.maximum(np.arange(s.samples * over) / (s.rate * over) - s.start, 0)
    modes = _modes(rng, s) if modes is None else modes
    wave = sum(
        a * np.exp(-z * 2 * np.pi * f * time) * np.sin(2 * np.pi * f * time + p) for f, z, a, p in modes
    )
    return level * wave * (time > 0)


def _modes(rng, s):
    count = int(rng.integers(1, 6))
    top = min(0.12 * s.rate, 0.7 / s.width)
    return [
        (rng.uniform(20, top), 10 ** rng.uniform(-3, -1.5), rng.uniform(0.2, 1), rng.uniform(0, 6.28))
        for _ in range(count)
    ]


def sampled(rng, s, wave, noise=None):
    noise = 10 ** rng.uniform(-4, -2.3) if noise is None else noise
    return wave + noise * np.abs(wave).max() * rng.standard_normal(len(wave))


def test_of(s, forces, motions):
    """Return a hammer test of hits at one point with one response."""
    hits = Hits(Dof(1, 3), (Dof(2, 3),), np.asarray(forces), np.asarray(motions)[:, None])
    return HammerTest(rate=s.rate, points=(hits,))


test_of.__test__ = False  # not for pytest


def one_force(rng, s, **faults):
    """Return a test of a single hit whose force has the faults asked for."""
    return test_of(s, [force(rng, s, **faults)], [sampled(rng, s, response(rng, s))])


def one_response(rng, s, fault):
    """Return a test of a single hit with a fault of its response: clip, clip and filter, cut, mute, drop."""
    over = OVER if fault == "clip and filter" else 1
    wave = response(rng, s, over=over)
    if fault in ("clip", "clip and filter"):
        wave = np.clip(wave, -1, 1) if np.abs(wave).max() > 1.6 else wave
        limit = 0.5 * np.abs(wave).max()
        wave = np.clip(wave, -limit, limit)
    if fault == "clip and filter":
        wave = low_pass(rng, wave, s, "fir")[::OVER]
    record = sampled(rng, s, wave, noise=0 if fault == "clip" else None)
    at = int((s.start + rng.uniform(0.05, 0.4) * (s.samples / s.rate - s.start)) * s.rate)
    if fault == "cut":
        record[at:] = 0.0
    if fault == "mute":
        record[at:] = 1e-4 * np.abs(record).max() * rng.standard_normal(s.samples - at)
    if fault == "drop":
        record[at : at + max(24, int(rng.uniform(0.02, 0.2) * s.samples))] = 0.0
    return test_of(s, [force(rng, s)], [record])


def several(rng, s, fault, hits=5):
    """Return a test of several hits at one point, of which some share a limit or one is odd, and which."""
    modes = _modes(rng, s)
    levels = np.exp(0.25 * rng.standard_normal(hits))
    forces = [force(rng, s) * level for level in levels]
    # one polarity, as the transducer is the same
    forces = [f * np.sign(f[np.abs(f - np.median(f)).argmax()] - np.median(f)) for f in forces]
    motions = [sampled(rng, s, response(rng, s, level=level, modes=modes)) for level in levels]
    bad = {int(rng.integers(hits))}
    (odd,) = bad
    if fault == "limit":
        limit = float(np.sort([f.max() for f in forces])[-2]) * 0.97
        bad = {i for i, f in enumerate(forces) if f.max() > limit}
        forces = [np.minimum(f, limit) for f in forces]
    if fault == "weak":
        forces[odd] = forces[odd] * 0.05
        motions[odd] = motions[odd] * 0.05
    if fault == "elsewhere":
        motions[odd] = sampled(rng, s, response(rng, s, level=levels[odd]))
    return test_of(s, forces, motions), bad if fault else set()
