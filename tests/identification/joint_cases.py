"""Hits on a structure with a joint that slips, integrated in time: true intermodulation, no poles and no residues."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acquisition import Dof, HammerTest, Hits

FINE = 8  # steps per sample


@dataclass(frozen=True, eq=False)
class Joint:
    """A modal model with one joint in it, whose force leaves the straight line by its square.

    ``shares`` are the motions of the joint in each mode; it pushes with ``-slip * u * |u|``, so that it gets softer
    where ``slip`` is negative.
    """

    slip: float
    frequency: NDArray[np.float64]
    shares: NDArray[np.float64]
    shapes: NDArray[np.float64]
    damping: float = 0.004

    def hits(self, push: NDArray[np.float64], points: NDArray[np.int64], step: float) -> NDArray[np.float64]:
        """Accelerations (n_steps, n_hits) of the last point: modes are exact, the joint and the push held each step."""
        omega = 2 * np.pi * self.frequency[:, None]
        fade = np.exp(-self.damping * omega * step)
        turn = 2 * fade * np.cos(omega * np.sqrt(1 - self.damping**2) * step)
        gain = (1 - turn + fade**2) / omega**2
        now, before = np.zeros((2, len(self.frequency), len(points)))
        seen, answer = self.shapes[-1], np.empty_like(push)
        for k, force in enumerate(push):
            u = self.shares @ now
            load = self.shapes[points].T * force - np.outer(self.shares, self.slip * u * np.abs(u))
            later = turn * now - fade**2 * before + gain * load
            answer[k] = seen @ (later - 2 * now + before) / step**2
            before, now = now, later
        return answer


def cantilever(slip: float, *, first: float = 34.4, points: int = 3) -> Joint:
    """Three modes of a cantilever whose root turns."""
    number = np.array([1.8751041, 4.6940911, 7.8547574])
    ratio = (np.cosh(number) + np.cos(number)) / (np.sinh(number) + np.sin(number))
    x = np.outer(np.linspace(0.5, 1.0, points), number)
    shapes = np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x))
    square = (number / number[0]) ** 2
    return Joint(slip, first * square, square / np.linalg.norm(square), shapes)


def joint_test(
    joint: Joint, seed: int, *, hits: int = 8, rate: float = 2048.0, samples: int = 4096, span: float = 4.0
) -> HammerTest:
    """Hits with peaks from 3 to 47 N or, in proportion, over another span; noise of 1e-4 of each record's peak."""
    rng, points = np.random.default_rng(seed), len(joint.shapes)
    level = 12.0 * np.exp(rng.uniform(-0.5, 0.5, points * hits) * np.log(span**2))
    start = 0.01 + rng.uniform(size=points * hits) / rate
    time = np.arange(FINE * samples)[:, None] / (FINE * rate)
    phase = np.clip((time - start) * rate / 2.5, 0.0, 1.0)
    push = level * np.sin(np.pi * phase) ** 2
    motion = joint.hits(push, np.repeat(np.arange(points), hits), 1 / (FINE * rate))
    force, motion = (_sampled(wave).T.reshape(points, hits, -1) for wave in (push, motion))
    motion = motion + 1e-4 * np.abs(motion).max(axis=-1, keepdims=True) * rng.standard_normal(motion.shape)
    force = force + 2e-3 * rng.standard_normal(force.shape)
    seen = (Dof(points, 3),)
    return HammerTest(
        rate,
        tuple(
            Hits(Dof(i + 1, 3), seen, f, m[:, None])
            for i, (f, m) in enumerate(zip(force, motion, strict=True))
        ),
        "accelerance",
        source="a joint that slips",
    )


def _sampled(fine: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pass a sharp filter at 0.42 of the rate, without delay, and keep one step of each sample."""
    spectrum = np.fft.rfft(fine, 2 * len(fine), axis=0)
    gain = np.clip(
        (0.48 * 2 * len(fine) / FINE - np.arange(len(spectrum))) / (0.06 * 2 * len(fine) / FINE), 0.0, 1.0
    )
    return np.fft.irfft(spectrum * gain[:, None], axis=0)[: len(fine) : FINE]
