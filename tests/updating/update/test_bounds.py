"""Steps of parameters that have bounds."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from updating.update.bounds import bounded_step


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
