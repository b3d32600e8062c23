"""Data worse than thought: found where they are, paid for, and no dearer than the sum over all settings."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from updating.likelihood.worse import Cells, worse_than_thought
from updating.thresholds import WORSE_CELL_PRIOR, WORSE_SCALES

MODES, POINTS = 5, 4


def single(count: int) -> Cells:
    """Every datum a cell of its own."""
    own = np.arange(count)
    return Cells(own, np.full(count, -1), count, np.ones(count, dtype=int))


def grid() -> Cells:
    """Constants of some points in some modes: a cell for each mode, and one for each point."""
    point, mode = (a.ravel() for a in np.indices((POINTS, MODES)))
    size = np.array([POINTS] * MODES + [MODES] * POINTS)
    return Cells(mode, MODES + point, MODES + POINTS, size)


def data(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    nuisance, variance = rng.standard_normal((count, 2)), rng.uniform(0.5, 2.0, count)
    return (
        nuisance @ rng.standard_normal(2) + np.sqrt(variance) * rng.standard_normal(count),
        nuisance,
        variance,
    )


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), off=st.sampled_from([0.0, 5.0, 12.0, 40.0]))
def test_the_gain_is_that_of_the_sum_over_every_setting_of_one_cell(seed: int, off: float) -> None:
    residual, nuisance, variance = data(seed, 8)
    residual[3] += off * np.sqrt(variance[3])
    found = worse_than_thought(residual, nuisance, variance, single(8))
    plain = logpdf(residual, nuisance, variance)
    every = [plain]
    for i, scale in product(range(8), WORSE_SCALES):
        factor = np.where(np.arange(8) == i, scale, 1.0)
        every.append(
            logpdf(residual, nuisance, variance * factor**2) + np.log(WORSE_CELL_PRIOR / len(WORSE_SCALES))
        )
    exact = float(logsumexp(every)) - plain
    assert found.gain >= 0
    if (found.factor > 1).sum() == 1:
        assert found.gain == pytest.approx(exact, abs=2.0)  # a bound: the settings found on the way only
        assert found.gain <= exact + 1e-9


def logpdf(residual: np.ndarray, nuisance: np.ndarray, variance: np.ndarray) -> float:
    return float(multivariate_normal.logpdf(residual, cov=np.diag(variance) + nuisance @ nuisance.T))


@pytest.mark.parametrize("cell", range(MODES + POINTS))
def test_a_bad_mode_and_a_bad_channel_are_told_from_each_other(cell: int) -> None:
    group = grid()
    residual, nuisance, variance = data(11, POINTS * MODES)
    bad = group.members(cell)
    residual[bad] += 12 * np.sqrt(variance[bad]) * np.where(np.arange(int(bad.sum())) % 2, 1.0, -1.0)
    found = worse_than_thought(residual, nuisance, variance, group)
    assert (found.factor[bad] > 1).all()
    assert found.gain > 0


def test_hardly_any_sound_test_has_a_cell_raised() -> None:
    raised = [(worse_than_thought(*data(seed, 20), grid()).factor > 1).any() for seed in range(200)]
    assert sum(raised) <= 4


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_order_of_the_data_does_not_matter(seed: int) -> None:
    residual, nuisance, variance = data(seed, 8)
    residual[2] += 9.0
    order = np.random.default_rng(seed + 1).permutation(8)
    found = worse_than_thought(residual, nuisance, variance, single(8))
    again = worse_than_thought(residual[order], nuisance[order], variance[order], single(8))
    assert again.gain == pytest.approx(found.gain, abs=1e-8)
    np.testing.assert_array_equal(again.factor, found.factor[order])
