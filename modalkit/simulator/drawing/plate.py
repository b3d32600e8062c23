"""Random plates and the tests on them."""

from __future__ import annotations

from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.plate.plate import Plate
from modalkit.simulator.drawing.common import (
    MATERIAL_SHARES,
    MATERIALS,
    draw_tank,
    draw_test,
    near_a_node,
    rayleigh,
    two_digits,
)
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.setup import Setup, Tolerances

_CLAMPS: tuple[tuple[str, ...], ...] = (("x0",), ("x0", "x1"), ("x0", "x1", "y0", "y1"), ())
_CLAMP_SHARES = (0.6, 0.1, 0.1, 0.2)
_THIN = 0.7
_THINNEST = 0.0008


def draw_plate(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    """Draw a plate and its test.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
        Share of baselines.

    Returns
    -------
    Setup or None
        A plate so thin that the thin theory of the study lacks less than its frequencies scatter; None where
        its first frequency is below 5 Hz or its band ends above 6 kHz.
    """
    length = round(rng.uniform(0.2, 0.6), 3)
    width = round(length * rng.uniform(0.4, 0.95), 3)
    thickness = round(max(0.001, width / np.exp(rng.uniform(np.log(60), np.log(200)))), 4)
    material = MATERIALS[int(rng.choice(3, p=MATERIAL_SHARES))]
    clamped = _CLAMPS[int(rng.choice(4, p=_CLAMP_SHARES))]
    points = _draw_points(rng, (length, width), clamped)
    sensor = int(rng.integers(len(points)))
    share, modes = rng.uniform(0.0, 0.006), int(rng.choice([5, 6, 7]))
    elements = int(rng.integers(16, 31)), int(rng.integers(10, 17))
    kinds, stated = draw_test(rng, plan), rng.random()
    tank: dict[str, Any] = draw_tank(rng, min(length, width)) if kinds["environment"] is not None else {}
    thickness = _thin_enough((length, width), thickness, material, clamped, modes, kinds["repeatability"])
    hz, seen = _bare_modes((length, width), thickness, material, clamped, modes, points)
    sensor = near_a_node(rng, seen, sensor)
    alpha, beta = rayleigh(rng, float(hz[0]), float(hz[-1]))
    window = round(rng.uniform(0.5, 2.0) * 0.5 * alpha, 2)
    if hz[0] < 5.0 or 1.2 * hz[-1] > 6000.0 or thickness < _THINNEST:
        return None
    return Setup(
        kind="plate",
        title=f"Plate of {1e3 * length:.0f} x {1e3 * width:.0f} x {1e3 * thickness:.1f} mm",
        length=length,
        width=width,
        thickness=thickness,
        E=material[0],
        density=material[1],
        poisson=material[2],
        clamped=clamped,
        theory="kirchhoff",
        elements=elements,
        tolerances=Tolerances(),
        alpha=alpha,
        beta=beta,
        points=points,
        sensor=sensor,
        sensor_mass=round(share * material[1] * length * width * thickness, 5),
        modes=modes,
        band=(two_digits(0.25 * hz[0]), two_digits(1.1 * hz[-1])),
        window=window if stated < 0.35 else 0.0,
        **kinds,
        **tank,
    )


def _bare_hz(
    size: tuple[float, float],
    thickness: float,
    material: tuple[float, float, float],
    clamped: tuple[str, ...],
    modes: int,
) -> FloatArray:
    return _bare_modes(size, thickness, material, clamped, modes)[0]


def _bare_modes(
    size: tuple[float, float],
    thickness: float,
    material: tuple[float, float, float],
    clamped: tuple[str, ...],
    modes: int,
    points: tuple[tuple[float, float], ...] = ((0.0, 0.0),),
) -> tuple[FloatArray, FloatArray]:
    """Return elastic frequencies [Hz] of the plate alone, and shapes at some points, (n_points, n_modes)."""
    E, density, poisson = material
    body = Plate(
        0.0, size[0], size[1], thickness, E, density, poisson=poisson, clamped=clamped, elements=(3, 2)
    )
    omega, shapes = body.real_modes(modes + body.rigid_modes)
    seen = body.rows(np.array(points), "w") @ shapes[:, body.rigid_modes :]
    return np.asarray(omega[body.rigid_modes :] / (2 * np.pi)), seen


def _thin_enough(
    size: tuple[float, float],
    thickness: float,
    material: tuple[float, float, float],
    clamped: tuple[str, ...],
    modes: int,
    repeatability: float,
) -> float:
    """Return the thickness, or the largest at which shear lowers the highest mode less than re-mounting does."""
    E, density, poisson = material
    rigidity = E * thickness**3 / 12 / (1 - poisson**2)
    highest = 2 * np.pi * _bare_hz(size, thickness, material, clamped, modes)[-1]
    wave = np.sqrt(highest * np.sqrt(density * thickness / rigidity))
    shift = (wave * thickness) ** 2 / 24 * (1 + 2 * (1 + poisson) / 0.85)
    return round(thickness * min(1.0, float(np.sqrt(_THIN * repeatability / shift))), 5)


def _draw_points(
    rng: np.random.Generator, size: tuple[float, float], clamped: tuple[str, ...]
) -> tuple[tuple[float, float], ...]:
    """Draw an uneven grid that keeps off the clamped edges; free edges may be hit."""
    axes = []
    for edges, count in ((("x0", "x1"), int(rng.integers(4, 6))), (("y0", "y1"), int(rng.integers(3, 5)))):
        low, high = (int(edge in clamped) for edge in edges)
        axes.append((np.arange(count) + low) / (count - 1 + low + high))
    x, y = (a.ravel() for a in np.meshgrid(*axes, indexing="ij"))
    spread = [0.15 / len(a) for a in axes]
    shares = [
        share + ((share > 0) & (share < 1)) * rng.uniform(-s, s, len(share))
        for share, s in zip((x, y), spread, strict=True)
    ]
    return tuple(
        (round(float(a), 3), round(float(b), 3))
        for a, b in zip(shares[0] * size[0], shares[1] * size[1], strict=True)
    )
