"""What is drawn alike for all kinds of specimens: materials, damping, and how the test is made."""

from __future__ import annotations

from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.drawing.ranges import DrawRanges

MATERIALS = ((210e9, 7850.0, 0.30), (70e9, 2700.0, 0.33), (100e9, 8500.0, 0.34))
"""E [Pa], density [kg/m3] and Poisson's ratio [-] of steel, aluminium and brass."""
MATERIAL_SHARES = (0.45, 0.4, 0.15)
FAINT = 0.15
"""Share of tests whose sensor sits near a node of some mode [-]."""
LEAST_SEEN = 0.01
"""What the sensor sees of every mode at least, over the mode's largest [-]."""


def draw_test(rng: np.random.Generator, plan: DrawRanges) -> dict[str, Any]:
    """Draw what has nothing to do with the specimen: how it is hit, recorded and calibrated.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
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


def near_a_node(rng: np.random.Generator, shapes: FloatArray, sensor: int) -> int:
    """Return the sensor's point, or now and then one at which some mode hardly moves.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    shapes : (n_points, n_modes) array
        Of the modes that the band was chosen for [any].
    sensor : int
        Index of the point drawn at first [-].

    Returns
    -------
    int
        The point that is nearest to a node of a mode drawn at random, but moves in all of them.
    """
    wanted, mode = rng.random() < FAINT, int(rng.integers(shapes.shape[1]))
    share = np.abs(shapes) / np.abs(shapes).max(axis=0)
    seen = np.where(share.min(axis=1) > LEAST_SEEN, share[:, mode], np.inf)
    return int(np.argmin(seen)) if wanted and np.isfinite(seen).any() else sensor


def draw_tank(rng: np.random.Generator, short: float) -> dict[str, float]:
    """Draw how far the surface and the bottom of a fluid are, each one there in half of the draws.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    short : float
        Shorter side of the specimen [m].

    Returns
    -------
    dict
        ``free_surface`` and ``bottom`` of those that are there [m].
    """
    there = {name: rng.random() < 0.5 for name in ("free_surface", "bottom")}
    far = np.exp(rng.uniform(np.log(0.15), np.log(2.0), size=2)) * short
    return {name: round(float(x), 4) for (name, here), x in zip(there.items(), far, strict=True) if here}


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
