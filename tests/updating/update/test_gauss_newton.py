"""Steps of parameters that have bounds."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from updating.update.gauss_newton import bounded_step, halved, least_squares_step


@given(seed=st.integers(0, 10_000), n=st.integers(1, 6))
def test_a_step_stays_inside_and_is_the_least_of_the_free(seed, n):
    """Parameters at a bound step inwards or not at all; the others step as if those were known."""
    rng = np.random.default_rng(seed)
    rows, load = rng.standard_normal((n + 3, n)), rng.standard_normal(n + 3)
    theta = rng.integers(0, 3, n) - 1.0  # at the lower bound, between, at the upper one
    step = bounded_step(
        lambda free: np.linalg.lstsq(rows[:, free], load, rcond=None)[0], theta, -np.ones(n), np.ones(n)
    )
    assert np.all(step[theta == -1] >= 0) and np.all(step[theta == 1] <= 0)
    moved = (step != 0) | (theta == 0)
    np.testing.assert_allclose(rows[:, moved].T @ (load - rows @ step), 0.0, atol=1e-9)


def test_a_direction_without_information_stays() -> None:
    rows, load = np.array([[1.0, 1.0], [2.0, 2.0]]), np.array([1.0, 2.0])
    np.testing.assert_allclose(least_squares_step(rows, load), [0.5, 0.5])
    assert not least_squares_step(rows, load, floor=10.0).any()


def test_a_step_is_halved_until_it_succeeds() -> None:
    def attempt(new: np.ndarray) -> float | None:
        return float(new[0]) if new[0] <= 0.3 else None

    bounds = np.zeros(1), np.full(1, 0.9)
    options = {"smallest": np.full(1, 1e-6), "most": 9}
    assert halved(attempt, np.zeros(1), np.ones(1), bounds, **options) == 0.25
    assert halved(attempt, np.full(1, 0.5), np.ones(1), bounds, **options) is None
