"""Added mass of water against published values."""

from __future__ import annotations

import numpy as np
import pytest

from modalkit.simulator.bodies.beam.water import added_mass, thickness_factor


# DNV-RP-C205, appendix D, rectangular plates moving across their plane: share of rho pi/4 a^2 b
@pytest.mark.parametrize(
    ("aspect", "coefficient"),
    [(1.0, 0.579), (1.5, 0.690), (2.0, 0.757), (3.0, 0.830), (5.0, 0.897), (10.0, 0.947)],
)
def test_rigid_plate(aspect: float, coefficient: float) -> None:
    _, matrix = added_mass(0.1 * aspect, 0.1, 1e-12, density=1000.0)
    whole = matrix.sum() / (1000 * np.pi / 4 * 0.1**2 * 0.1 * aspect)
    assert whole == pytest.approx(coefficient, abs=2e-3)


# DNV-RP-C205, appendix D, rectangles: added mass over rho pi a^2, 2a across the motion
@pytest.mark.parametrize(
    ("ratio", "factor"), [(0.1, 1.14), (0.2, 1.21), (0.5, 1.36), (1.0, 1.51), (2.0, 1.70), (5.0, 1.98)]
)
def test_rectangle(ratio: float, factor: float) -> None:
    assert thickness_factor(ratio) == pytest.approx(factor, abs=0.011)


def test_matrix_is_symmetric_positive_and_less_for_short_waves() -> None:
    x, matrix = added_mass(1.0, 0.1, 0.002, density=998.0)
    np.testing.assert_allclose(matrix, matrix.T)
    assert np.linalg.eigvalsh(matrix)[0] > 0
    energy = [np.sin(n * np.pi * x) @ matrix @ np.sin(n * np.pi * x) for n in (1, 3, 6, 9)]
    assert np.all(np.diff(energy) < 0)


def test_long_waves_approach_the_strip() -> None:
    x, matrix = added_mass(10.0, 0.1, 1e-12, density=1.0, along=80)
    energy = np.sin(np.pi * x / 10) @ matrix @ np.sin(np.pi * x / 10)
    assert energy == pytest.approx(np.pi / 4 * 0.1**2 * 5.0, rel=5e-3)
