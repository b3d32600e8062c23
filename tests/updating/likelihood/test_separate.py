"""Nuisances with data of their own: what is integrated out group by group is what one large Gaussian gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from acquisition.arrays import BoolArray, FloatArray
from updating.likelihood.comparison import CHANNELS, Comparison
from updating.likelihood.gaussian import gaussian, marginal, marginals, normal_equations
from updating.likelihood.separate import separate
from updating.thresholds import FEW_NUISANCES, MOST_TOGETHER, SHAPE_NOISE_SCALES

Pattern = tuple[int, int, int, int]


def comparison(pattern: Pattern, seed: int) -> Comparison:
    """Return random data of points, modes, directions and sensors, with places, gains, scatter of each frequency."""
    points, modes, directions, sensors = pattern
    rng = np.random.default_rng(seed)
    frfs = points * sensors
    n = modes + frfs * modes
    columns = [rng.standard_normal((n, 3)), np.vstack([np.eye(modes), np.zeros((frfs * modes, modes))])]
    for ends in (np.tile(np.arange(points), sensors), np.repeat(np.arange(sensors), points)):
        for place in np.unique(ends):
            block = rng.standard_normal((frfs, modes, directions)) * (ends == place)[:, None, None]
            columns.append(np.vstack([np.zeros((modes, directions)), block.reshape(-1, directions)]))
    columns.append(np.zeros((n, FEW_NUISANCES)))  # of places that move nothing
    nuisance = np.hstack(columns)
    channel = np.repeat([CHANNELS.index("frequency"), CHANNELS.index("frf")], [modes, frfs * modes])
    return Comparison(
        residual=rng.standard_normal(n), nuisance=nuisance[:, rng.permutation(nuisance.shape[1])],
        variance=rng.uniform(0.01, 0.1, n), channel=channel,
        mode=np.tile(np.arange(modes), 1 + frfs), source=np.repeat(np.arange(-1, frfs), modes), predictions=(),
        scale_prior=tuple(np.full(len(SHAPE_NOISE_SCALES), 1 / len(SHAPE_NOISE_SCALES))), doubts=np.arange(1),
        tolerances=np.arange(1),
    )  # fmt: skip


def covariance(data: Comparison, scale: float, keep: BoolArray) -> FloatArray:
    return np.diag(data.noise(scale)[keep]) + data.nuisance[keep] @ data.nuisance[keep].T


patterns = st.tuples(st.integers(2, 9), st.integers(1, 4), st.integers(1, 3), st.integers(1, 2))


@settings(max_examples=30)
@given(pattern=patterns, seed=st.integers(0, 2**31), share=st.floats(0.5, 1.0))
def test_the_likelihood_is_that_of_one_normal_distribution(pattern: Pattern, seed: int, share: float) -> None:
    data = comparison(pattern, seed)
    keep = np.random.default_rng(seed + 1).random(len(data.residual)) < share
    keep[0] = True
    parts = gaussian(data, SHAPE_NOISE_SCALES[::3], keep)
    for k, scale in enumerate(parts.scales.tolist()):
        whole = covariance(data, scale, keep)
        residual = data.residual[keep]
        expected = multivariate_normal(np.zeros(len(residual)), whole).logpdf(residual)
        assert parts.log_likelihood[0, 0, k] == pytest.approx(float(expected), rel=1e-9, abs=1e-7)
        # the most probable nuisances are their covariance with the data, divided by the data's own
        shift = data.nuisance[keep].T @ np.linalg.solve(whole, residual)
        found = parts.shift(np.array([0]), np.array([k]))[0]
        np.testing.assert_allclose(found, shift, atol=1e-8)


@settings(max_examples=20)
@given(pattern=patterns, seed=st.integers(0, 2**31))
def test_the_normal_equations_are_those_of_generalised_least_squares(pattern: Pattern, seed: int) -> None:
    data = comparison(pattern, seed)
    every = np.ones(len(data.residual), dtype=bool)
    columns = np.random.default_rng(seed).standard_normal((len(every), 2))
    normal, load = normal_equations(data, columns, 2.0)
    weighed = np.linalg.solve(covariance(data, 2.0, every), columns)
    np.testing.assert_allclose(normal, columns.T @ weighed, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(load, weighed.T @ data.residual, rtol=1e-8, atol=1e-8)


@settings(max_examples=30)
@given(
    seed=st.integers(0, 2**31), rows=st.integers(1, 40), columns=st.integers(FEW_NUISANCES, FEW_NUISANCES + 20),
    filled=st.sampled_from([0.0, 0.01, 0.05, 0.3, 1.0]),
)  # fmt: skip
def test_groups_share_no_row_and_no_nuisance_is_lost(
    seed: int, rows: int, columns: int, filled: float
) -> None:
    rng = np.random.default_rng(seed)
    nuisance = rng.standard_normal((rows, columns)) * (rng.random((rows, columns)) < filled)
    scaled = rng.random(rows) < 0.5
    found = separate(nuisance, scaled)
    grouped = found.columns[found.columns >= 0]
    touching = np.flatnonzero(nuisance.any(axis=0))
    assert sorted([*grouped.tolist(), *found.common.tolist()]) == touching.tolist()
    assert len(np.unique(found.rows)) == len(found.rows)
    assert found.columns.shape[1] <= MOST_TOGETHER
    ends = [*found.starts.tolist(), len(found.rows)][1:]
    for group, start, end, one in zip(found.columns, found.starts, ends, found.scaled, strict=True):
        own = group[group >= 0]
        assert set(np.flatnonzero(nuisance[:, own].any(axis=1))) == set(found.rows[start:end].tolist())
        np.testing.assert_array_equal(
            found.values(nuisance)[start:end, : len(own)], nuisance[found.rows[start:end]][:, own]
        )
        assert (scaled[found.rows[start:end]] == one).all()


def test_of_a_roving_hammer_only_what_all_points_share_is_common() -> None:
    """Sixty points in three directions: 180 places of hits are groups; gains and the sensor's place are common."""
    data = comparison((60, 10, 3, 1), 0)
    found = separate(data.nuisance, data.scaled)
    assert len(found.common) == 3 + 3
    assert (found.columns >= 0).sum() == 180 + 10


def test_the_doubt_in_the_idealisation_is_summed_over_with_groups_as_without() -> None:
    data = comparison((8, 3, 3, 1), 3)
    data = replace(data, idealised=0.3 * data.variance)
    few = replace(data, nuisance=data.nuisance[:, data.nuisance.any(axis=0)])
    assert few.nuisance.shape[1] <= FEW_NUISANCES < data.nuisance.shape[1]  # one large matrix, groups
    assert marginal(data).log_likelihood == pytest.approx(marginal(few).log_likelihood, rel=1e-12)
    assert marginal(data).share == marginal(few).share


def test_a_prediction_far_from_the_data_that_a_nuisance_brings_back_is_no_error() -> None:
    """Its chi-squared is a small difference of two numbers whose round-off exceeds it."""
    data = comparison((9, 4, 3, 2), 3)
    far = 1e7 * np.ones(len(data.residual))
    near = replace(data, residual=-far, nuisance=0.02 * far[:, None], variance=np.full(len(far), 1e-7))
    assert np.isfinite(marginal(near).log_likelihood)


@settings(max_examples=15)
@given(pattern=patterns, seed=st.integers(0, 2**31))
def test_many_comparisons_at_once_are_each_by_itself(pattern: Pattern, seed: int) -> None:
    rng = np.random.default_rng(seed)
    data = comparison(pattern, seed)
    judged = np.where(data.channel == CHANNELS.index("frequency"), 0.5 * data.variance, 0.0)
    data = replace(data, judged=judged, judged_columns=np.zeros(data.nuisance.shape[1], dtype=bool))
    size = data.nuisance.shape
    many = [
        replace(
            data, residual=rng.standard_normal(size[0]), nuisance=data.nuisance * rng.uniform(0.5, 2.0, size)
        )
        for _ in range(3)
    ]
    other = replace(data, nuisance=np.where(rng.random(size) < 0.5, data.nuisance, 0.0))
    impossible = replace(data, residual=np.full(size[0], np.nan))
    together = marginals([*many, other, impossible])
    for one, found in zip([*many, other, impossible], together, strict=True):
        alone = marginal(one)
        assert found.log_likelihood == pytest.approx(alone.log_likelihood, rel=1e-12)
        np.testing.assert_allclose(found.shift, alone.shift, rtol=1e-9, atol=1e-12)
        assert (found.scale, found.share, found.unseen, found.judged) == (
            alone.scale, alone.share, alone.unseen, alone.judged,
        )  # fmt: skip
