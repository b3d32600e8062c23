"""A linear step of two effects together, where either does the same to the data."""

from __future__ import annotations

import numpy as np
import pytest

from updating.diagnosis.search.together import linear_step


@pytest.mark.parametrize("size", [1.0, 1e3, 1e12])
def test_effects_that_do_the_same_share_the_step(size):
    column = size * np.array([1.0, 2.0, -1.0])
    columns = np.stack([column, column, [0.0, 1.0, 2.0]], axis=1)
    normal = columns.T @ columns + np.eye(3)
    step = linear_step(normal, columns.T @ np.array([1.0, 2.5, 0.0]))
    assert step[0] == pytest.approx(step[1], rel=1e-3)
    assert 0.5 * (columns.T @ [1.0, 2.5, 0.0]) @ step > 0


@pytest.mark.parametrize("count", [0, 1, 5])
def test_effects_of_their_own_step_as_the_equations_say(rng, count):
    columns = rng.standard_normal((9, count)) * np.logspace(0, 8, count)
    normal, load = columns.T @ columns + np.eye(count), columns.T @ rng.standard_normal(9)
    assert linear_step(normal, load) == pytest.approx(np.linalg.solve(normal, load), rel=1e-6)
