"""What is drawn alike for all kinds of specimens: materials, damping, and how the test is made."""

from __future__ import annotations

from typing import Any

import numpy as np

from modalkit.simulator.drawing.ranges import DrawRanges

MATERIALS = ((210e9, 7850.0, 0.30), (70e9, 2700.0, 0.33), (100e9, 8500.0, 0.34))
"""E [Pa], density [kg/m3] and Poisson's ratio [-] of steel, aluminium and brass."""
MATERIAL_SHARES = (0.45, 0.4, 0.15)


def draw_test(rng: np.random.Generator, plan: DrawRanges) -> dict[str, Any]:
    """Draw what has nothing to do with the specimen: how it is hit, recorded and calibrated.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : Plan
        Share of baselines.

    Returns
    -------
    dict
        Fields of ``Setup``.
    """
    return {
        "drive": bool(rng.random() < 0.7),
        "sensor_sign": -1 if rng.random() < 0.15 else 1,
        "hits": int(rng.integers(3, 7)),
        "peak": float(f"{np.exp(rng.uniform(np.log(20), np.log(300))):.2g}"),
        "level_scatter": float(rng.choice([0.15, 0.3, 0.5])),
        "bad_hits": float(rng.choice([0.0, 0.02, 0.05])),
        "noise": float(f"{np.exp(rng.uniform(np.log(2e-4), np.log(5e-3))):.1e}"),
        "noise_slope": float(rng.choice([0.0, -0.5, -1.0])),
        "bits": int(rng.choice([16, 24])),
        "calibration": float(rng.choice([0.005, 0.01, 0.02, 0.05, 0.5], p=[0.2, 0.25, 0.25, 0.2, 0.1])),
        "repeatability": float(rng.choice([0.0002, 0.0005, 0.001])),
        "position_sigma": float(rng.choice([0.0005, 0.001, 0.002])),
        "baseline": bool(rng.random() < plan.baseline),
        "environment": 998.0 if rng.random() < 0.25 else None,
    }


def rayleigh(rng: np.random.Generator, lowest: float, highest: float) -> tuple[float, float]:
    """Draw alpha [1/s] and beta [s] that give plausible ratios to two modes.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    lowest, highest : float
        Their frequencies [Hz].
    """
    omega = 2 * np.pi * np.array([lowest, highest])
    ratios = np.array([rng.uniform(0.005, 0.012), rng.uniform(0.001, 0.004)])
    alpha, beta = np.linalg.solve(0.5 * np.column_stack([1 / omega, omega]), ratios)
    return round(float(alpha), 4), float(f"{max(beta, 0.0):.3e}")


def two_digits(value: float) -> float:
    """Return a value rounded to two significant digits."""
    return float(f"{value:.2g}")
