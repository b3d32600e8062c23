"""Structures that are tested, drawn: a cantilever, a plate clamped along one edge, an airframe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CLAMPED = np.array([1.8751041, 4.6940911, 7.8547574, 10.9955407, 14.1371684, 17.2787596, 20.4203522])
FREE = np.array([4.7300407, 7.8532046, 10.9956078, 14.1371655])
Array = NDArray[np.float64]


def clamped_free(number: int, x: Array) -> Array:
    """Return a shape of a cantilever of unit length, unit mean square."""
    b = CLAMPED[number]
    s = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    return np.cosh(b * x) - np.cos(b * x) - s * (np.sinh(b * x) - np.sin(b * x))


def free_free(number: int, x: Array) -> Array:
    """Return a shape of a free beam of unit length, unit mean square; 0 and 1 are rigid."""
    if number < 2:
        return np.ones_like(x) if number == 0 else np.sqrt(3.0) * (2 * x - 1)
    b = FREE[number - 2]
    s = (np.cosh(b) - np.cos(b)) / (np.sinh(b) - np.sin(b))
    return np.cosh(b * x) + np.cos(b * x) - s * (np.sinh(b * x) + np.sin(b * x))


@dataclass(frozen=True, eq=False)
class Body:
    """A structure: frequencies [Hz], shapes and their slopes at its points, damping, and what is tested up to."""

    hertz: Array
    shapes: Array
    slopes: tuple[Array, Array]
    damping: float
    top: float


def beam(rng: np.random.Generator) -> Body:
    """Draw a cantilever."""
    length, mass = rng.uniform(0.4, 1.2), rng.uniform(0.5, 6.0)
    hertz = rng.uniform(6.0, 40.0) * (CLAMPED / CLAMPED[0]) ** 2
    x = np.linspace(0.1, 1.0, int(rng.integers(5, 16)))
    shapes, slope = (np.stack([f(k) for k in range(7)], axis=1) / np.sqrt(mass) for f in (
        lambda k: clamped_free(k, x), lambda k: _slope(lambda at: clamped_free(k, at), x) / length
    ))  # fmt: skip
    top = float(rng.uniform(0.6, 0.9) * hertz[int(rng.integers(3, 6))])
    return Body(hertz, shapes, (slope, 0 * slope), 0.002, top)


def plate(rng: np.random.Generator) -> Body:
    """Draw a plate clamped along one edge, its shapes products of those of beams."""
    mass, long, wide = rng.uniform(1.0, 8.0), rng.uniform(0.3, 0.6), rng.uniform(0.15, 0.4)
    first, ratio = rng.uniform(15.0, 40.0), rng.uniform(1.5, 3.5)
    kinds = [(i, j) for i in range(4) for j in range(4)]
    bending = (CLAMPED / CLAMPED[0]) ** 2
    across = [0.0, *(6.4 * ratio**2 * (FREE[:2] / FREE[0]) ** 2)]
    own = np.array(
        [np.hypot(bending[i], 2.2 * ratio * (i + 0.6) if j == 1 else across[j - (j > 1)]) for i, j in kinds]
    )
    order = np.argsort(own)
    gx, gy = np.meshgrid(np.linspace(0.2, 1.0, 5), np.linspace(0.0, 1.0, 5), indexing="ij")
    x, y, kinds = gx.ravel(), gy.ravel(), [kinds[k] for k in order]
    along, over = (
        [f(k) for k in range(4)] for f in (lambda k: clamped_free(k, x), lambda k: free_free(k, y))
    )
    dx = [_slope(lambda at, k=k: clamped_free(k, at), x) / long for k in range(4)]
    dy = [_slope(lambda at, k=k: free_free(k, at), y) / wide for k in range(4)]
    shapes = np.stack([along[i] * over[j] for i, j in kinds], axis=1) / np.sqrt(mass)
    slopes = [np.stack(s, axis=1) / np.sqrt(mass) for s in (
        [dx[i] * over[j] for i, j in kinds], [along[i] * dy[j] for i, j in kinds]
    )]  # fmt: skip
    hertz = first * own[order]
    return Body(
        hertz,
        shapes,
        (slopes[0], slopes[1]),
        0.002,
        float(rng.uniform(0.95, 1.05) * hertz[int(rng.integers(6, 11))]),
    )


def airframe(rng: np.random.Generator) -> Body:
    """Draw 13 modes at 74 points, two pairs closer than 2 %."""
    hertz = np.cumsum(rng.uniform(5.0, 14.0, 13)) + 10.0
    for k in (4, 8):
        hertz[k + 1] = hertz[k] * (1 + rng.uniform(0.008, 0.018))
    hertz = np.sort(hertz)
    x, y = rng.uniform(size=74), rng.uniform(size=74)
    wave, phase = rng.uniform(0.5, 4.0, (2, 13)), rng.uniform(0, 2 * np.pi, (2, 13))
    shapes = np.cos(wave[0] * np.pi * x[:, None] + phase[0]) * np.cos(wave[1] * np.pi * y[:, None] + phase[1])
    shapes = 2 * shapes / np.sqrt(rng.uniform(5.0, 20.0))
    return Body(hertz, shapes, (0 * shapes, 0 * shapes), 0.01, float(hertz[-1] + 8.0))


def _slope(shape: Callable[[Array], Array], x: Array) -> Array:
    step = 1e-6
    return (shape(x + step) - shape(x - step)) / (2 * step)
