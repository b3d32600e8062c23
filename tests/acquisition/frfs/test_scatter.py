"""The covariance of FRFs from the repeated hits: true in size, between responses and between lines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from acquisition import (
    Dof,
    FrfSet,
    HammerPlan,
    HammerTest,
    Hits,
    InputError,
    Windows,
    estimate_frfs,
    hammer_test,
    modal_system,
)
from acquisition.frfs.scatter import HitGroup, HitScatter, variance_of_groups

SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0]),
    damping=np.array([0.02, 0.015]),
    response_shapes=np.array([[1.0, 0.7], [0.4, -0.8]]),
    point_shapes=np.array([[1.0, 0.7], [0.9, -0.3]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3), Dof(5, 3)),
)
PLAN = HammerPlan(rate=1024.0, samples=1024, hits=4, width=4e-3, response_noise=5e-3, adc_bits=None)


def noisy(seed: int, **more: object) -> HammerTest:
    return hammer_test(SYSTEM, replace(PLAN, **more), rng=np.random.default_rng(seed))


def flat(frfs: FrfSet):
    """The set's FRFs one after the other, and its deviations alike, one row per hit."""
    n_frf, n_lines = frfs.values.shape
    rows = []
    for frf_rows, deviation in frfs.scatter.of_hits():
        row = np.zeros((n_frf, n_lines), dtype=complex)
        row[frf_rows] = deviation
        rows.append(row.ravel())
    return frfs.values.ravel(), np.array(rows)


TESTS = 200


@pytest.mark.long
@pytest.mark.parametrize("force_noise", [0.0, 0.4])
def test_covariances_stated_are_those_that_occur(force_noise):
    """Force noise ties the responses of a hit together, a window the lines; over many tests both are right."""
    names = ("H1", "H2", "Hv")
    values, stated = {name: [] for name in names}, dict.fromkeys(names, 0.0)
    for seed in range(TESTS):
        test = noisy(seed, force_noise=force_noise, response_noise=0.0, response_floor=0.2)
        for name in names:
            frfs = estimate_frfs(test, estimator=name, windows=Windows(decay=8.0), band=(52.0, 68.0))
            found, deviations = flat(frfs)
            values[name].append(found)
            stated[name] = stated[name] + deviations.T @ deviations.conj() / TESTS
    for name in names:
        agree(np.cov(np.array(values[name]).T), stated[name], len(frfs.frequency), tied=force_noise > 0)


def agree(happened, stated, n, *, tied):
    """Compare covariances that occurred with those stated, of four FRFs of n lines, two responses to a hit."""
    size = np.sqrt(np.diag(happened).real)
    assert np.sqrt(np.diag(stated).real) == pytest.approx(size, rel=0.2)  # over 200 tests it errs by 0.05
    # a ratio over 200 tests of so few independent lines errs by 0.06
    assert np.trace(stated).real == pytest.approx(np.trace(happened).real, rel=0.12)
    correlation, claimed = (m / np.outer(size, size) for m in (happened, stated))
    assert np.abs(claimed - correlation).max() < 0.25  # a correlation over 200 tests errs by 0.07
    near = np.abs(correlation[np.arange(n - 1), np.arange(1, n)])
    assert near.min() > 0.8  # the window does that
    between = np.abs(np.diag(correlation[:n, n : 2 * n]))
    assert (between.min() > 0.8) if tied else (between.max() < 0.3)
    assert np.abs(np.diag(claimed[: 2 * n, 2 * n :])).max() == 0  # other hits


def test_variance_is_the_diagonal_and_covariance_the_product():
    frfs = estimate_frfs(noisy(1)).band(20.0, 200.0)
    assert np.allclose(frfs.scatter.variance(4), frfs.variance, rtol=1e-5)
    own = frfs.scatter.of_frf(3)
    other = frfs.scatter.of_frf(2)
    assert own.shape == (4, len(frfs.frequency))
    expected = sum(a[:, None] * b.conj() for a, b in zip(own, other, strict=True))
    assert np.allclose(frfs.scatter.covariance(3, 2), expected, rtol=1e-4, atol=1e-12)
    assert not frfs.scatter.covariance(0, 2).any()
    assert [rows.tolist() for rows in frfs.scatter.hit_groups] == [[0, 1], [2, 3]]


@pytest.mark.long
def test_unequal_hits_leave_no_bias():
    """Hits of very different strength, equal noise: the weak ones must not spoil the stated variance."""
    ratios = []
    exact = None
    for seed in range(300):
        frfs = estimate_frfs(noisy(seed, level_scatter=0.8, response_noise=0.0, response_floor=1.0))
        frfs = frfs.band(20.0, 200.0)
        exact = SYSTEM.receptance(frfs.laplace, 0) * frfs.laplace**2 if exact is None else exact
        ratios.append((frfs.variance[:2].sum(), (np.abs(frfs.values[:2] - exact) ** 2).sum()))
    stated, happened = np.mean(ratios, axis=0)
    assert stated == pytest.approx(happened, rel=0.1)


def test_the_scatter_goes_where_the_frfs_go():
    whole = estimate_frfs(noisy(1))
    band = whole.band(20.0, 200.0)
    cut = estimate_frfs(noisy(1), band=(20.0, 200.0))
    assert np.array_equal(band.values, cut.values)
    assert np.array_equal(flat(band)[1], flat(cut)[1])
    some = band.select([3, 0])
    assert np.array_equal(some.scatter.of_frf(0), band.scatter.of_frf(3))
    assert np.array_equal(some.scatter.of_frf(1), band.scatter.of_frf(0))
    for form in ("receptance", "mobility"):
        other = band.to(form)
        assert np.allclose(other.scatter.variance(4), other.variance, rtol=1e-5)
        back = other.to("accelerance")
        assert np.allclose(flat(back)[1], flat(band)[1], rtol=1e-5)
    twice = band.scaled(np.array([1.0, -2.0, 1.0, 0.5]))
    assert np.allclose(twice.scatter.of_frf(1), -2 * band.scatter.of_frf(1))
    assert np.allclose(twice.scatter.variance(4), twice.variance, rtol=1e-5)
    assert replace(band, variance=None).scatter is None


def test_a_band_of_it_is_a_view():
    frfs = estimate_frfs(noisy(1))
    assert np.shares_memory(
        frfs.band(20.0, 200.0).scatter.groups[0].deviations, frfs.scatter.groups[0].deviations
    )
    assert frfs.scatter.groups[0].deviations.dtype == np.complex64


def test_it_is_left_out_on_request_and_where_there_is_one_hit():
    without = estimate_frfs(noisy(1), keep_scatter=False)
    assert without.scatter is None and np.array_equal(without.variance, estimate_frfs(noisy(1)).variance)
    assert estimate_frfs(noisy(1, hits=1)).scatter is None


def test_sets_are_joined_with_their_numbers_shifted():
    one = estimate_frfs(noisy(1)).band(20.0, 200.0)
    both = HitScatter.joined([one.scatter, one.scatter], [4, 4])
    assert [rows.tolist() for rows in both.hit_groups] == [[0, 1], [2, 3], [4, 5], [6, 7]]
    assert np.array_equal(both.of_frf(7), one.scatter.of_frf(3))
    assert HitScatter.joined([one.scatter, None], [4, 4]) is None


def test_runs_at_one_point_do_not_share_hits():
    (hits, _) = noisy(1).points
    runs = replace(
        noisy(1), points=(hits, Hits(hits.reference, (Dof(7, 3), Dof(8, 3)), hits.force, hits.motion))
    )
    assert [r.tolist() for r in estimate_frfs(runs).scatter.hit_groups] == [[0, 1], [2, 3]]


def test_what_does_not_belong_is_refused():
    frfs = estimate_frfs(noisy(1))
    with pytest.raises(InputError, match="does not belong"):
        replace(frfs, scatter=frfs.scatter.lines(slice(0, 9)))
    with pytest.raises(InputError, match="deviations"):
        HitGroup(np.arange(2), np.zeros((3, 4, 5)))
    with pytest.raises(InputError, match="no groups"):
        HitScatter(())


def test_degrees_of_freedom_make_the_intervals_true(rng):
    """Sums of group means of 3 hits, groups of unequal noise: 95 % intervals by t hold, by 1.96 they do not."""
    noise = np.array([1.0, 2.0, 0.5, 1.5])[:, None, None]
    draws = noise * rng.standard_normal((4, 3, 40000))
    means = draws.mean(axis=1, keepdims=True)
    contributions = (draws - means) / 3 / np.sqrt(2 / 3)
    variance, freedom = variance_of_groups(list(contributions))
    score = np.abs(means.sum(axis=(0, 1))) / np.sqrt(variance)
    assert variance.mean() == pytest.approx((noise**2).sum() / 3, rel=0.02)
    assert np.mean(score < stats.t.ppf(0.975, freedom)) == pytest.approx(0.95, abs=0.012)
    assert np.mean(score < 1.96) < 0.92


def test_degrees_of_freedom_of_equal_groups_add_up():
    ones = np.ones((4, 2)) * [1.0, 0.0]
    variance, freedom = variance_of_groups([ones, ones, ones])
    assert variance.tolist() == [12.0, 0.0] and freedom == pytest.approx([9.0, np.inf])
