"""Random specimens and tests, drawn without knowledge of the hidden effect."""

from __future__ import annotations

import numpy as np

from modalkit.blind.bodies.beam import Beam
from modalkit.blind.setup import Setup, Tolerances

_STEEL = (210e9, 7850.0, 0.30)
_ALUMINIUM = (70e9, 2700.0, 0.33)


def draw_setup(rng: np.random.Generator) -> Setup:
    """Draw a specimen and its test.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    Setup
        One whose first frequency is at least 5 Hz and whose band ends below 6 kHz.
    """
    while True:
        setup = _draw_once(rng)
        if setup is not None:
            return setup


def _draw_once(rng: np.random.Generator) -> Setup | None:
    length = round(rng.uniform(0.25, 1.0), 3)
    thickness = round(max(0.002, length / np.exp(rng.uniform(np.log(20), np.log(150)))), 4)
    width = round(rng.uniform(max(0.015, 1.5 * thickness), max(0.02, 2 * thickness, 0.2 * length)), 3)
    E, density, poisson = _STEEL if rng.random() < 0.5 else _ALUMINIUM
    clamped = bool(rng.random() < 0.7)
    points = _draw_points(rng, length, clamped)
    ends = [len(points) - 1] if clamped else [0, len(points) - 1]
    sensor = int(rng.choice(ends)) if rng.random() < 0.5 else int(rng.integers(len(points)))
    sensor_mass = round(rng.uniform(0.0, 0.01) * density * length * width * thickness, 5)
    modes = int(rng.choice([4, 5]))
    bare = _nominal_hz(length, thickness, E, density, poisson, clamped=clamped, count=modes)
    band = (_two_digits(0.25 * bare[0]), _two_digits(1.2 * bare[-1]))
    alpha, beta = _rayleigh(rng, bare)
    theory = "euler-bernoulli" if rng.random() < 0.3 else "timoshenko"
    window = round(rng.uniform(0.5, 2.0) * 0.5 * alpha, 2) if rng.random() < 0.35 else 0.0
    if bare[0] < 5.0 or band[1] > 6000.0:
        return None
    return Setup(
        title=f"Beam of {1e3 * length:.0f} x {1e3 * width:.0f} x {1e3 * thickness:.1f} mm",
        length=length,
        width=width,
        thickness=thickness,
        E=E,
        density=density,
        poisson=poisson,
        clamped=clamped,
        theory=theory,
        elements=int(rng.integers(20, 41)),
        tolerances=Tolerances(),
        alpha=alpha,
        beta=beta,
        points=points,
        sensor=sensor,
        drive=bool(rng.random() < 0.7),
        sensor_sign=-1 if rng.random() < 0.15 else 1,
        sensor_mass=sensor_mass,
        modes=modes,
        band=band,
        hits=int(rng.integers(3, 7)),
        noise=float(f"{np.exp(rng.uniform(np.log(2e-4), np.log(5e-3))):.1e}"),
        bits=int(rng.choice([16, 24])),
        calibration=float(rng.choice([0.005, 0.01, 0.02, 0.05])),
        repeatability=float(rng.choice([0.0002, 0.0005, 0.001])),
        position_sigma=float(rng.choice([0.0005, 0.001, 0.002])),
        window=window,
        baseline=bool(rng.random() < 0.25),
        environment=998.0 if rng.random() < 0.25 else None,
    )


def _draw_points(rng: np.random.Generator, length: float, clamped: bool) -> tuple[float, ...]:
    count = int(rng.integers(5, 10))
    even = np.arange(1, count + 1) / count if clamped else np.linspace(0.0, 1.0, count)
    inner = (even > 0) & (even < 1)
    jittered = even + inner * rng.uniform(-0.2, 0.2, count) / count
    return tuple(round(float(x), 3) for x in length * jittered)


def _nominal_hz(
    length: float, thickness: float, E: float, density: float, poisson: float, *, clamped: bool, count: int
) -> tuple[float, ...]:
    beam = Beam(0.0, length, 0.02, thickness, E, density, poisson, clamped, elements=5)
    skip = 0 if clamped else 2
    omega, _ = beam.real_modes(count + skip)
    return tuple(float(f) for f in omega[skip:] / (2 * np.pi))


def _rayleigh(rng: np.random.Generator, hz: tuple[float, ...]) -> tuple[float, float]:
    """Draw alpha [1/s] and beta [s] that give plausible ratios to the first and the last mode."""
    omega = 2 * np.pi * np.array([hz[0], hz[-1]])
    ratios = np.array([rng.uniform(0.005, 0.012), rng.uniform(0.001, 0.004)])
    alpha, beta = np.linalg.solve(0.5 * np.column_stack([1 / omega, omega]), ratios)
    return round(float(alpha), 4), float(f"{max(beta, 0.0):.3e}")


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")
