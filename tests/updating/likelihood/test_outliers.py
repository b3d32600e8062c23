"""Data worse than stated: what it does to a comparison, what it costs, and which group is suspected."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.likelihood.outliers import Outlier, log_price, suspects, with_outliers

MODES, ROWS = 5, 4


def comparison(seed: int, *, off: dict[int, float] | None = None) -> Comparison:
    """Five modes, each with a frequency and constants at four places; two tolerances."""
    rng = np.random.default_rng(seed)
    channel = np.array([0] * MODES + [2] * MODES * ROWS)
    mode = np.concatenate([np.arange(MODES), np.tile(np.arange(MODES), ROWS)])
    source = np.concatenate([np.full(MODES, -1), np.repeat(np.arange(ROWS), MODES)])
    nuisance = np.zeros((len(channel), 2))
    nuisance[:MODES, 0] = 3.0
    nuisance[:, 1] = rng.normal(size=len(channel))
    residual = nuisance @ rng.normal(size=2) + rng.normal(size=len(channel))
    for i, sigmas in (off or {}).items():
        residual[i] += sigmas
    return Comparison(
        residual=residual,
        nuisance=nuisance,
        variance=np.ones(len(channel)),
        channel=channel,
        mode=mode,
        source=source,
        predictions=(),
        scale_prior=(1.0, 1e-12, 1e-12, 1e-12, 1e-12),
        doubts=np.arange(2),
        tolerances=np.arange(1),
    )


def test_an_outlier_has_more_noise_and_nothing_else_changes() -> None:
    plain = comparison(1)
    worse = with_outliers(plain, [Outlier(mode=2, channel=0, scale=10.0)])
    assert worse.variance[2] == pytest.approx(100.0)
    assert np.delete(worse.variance, 2) == pytest.approx(np.delete(plain.variance, 2))
    assert worse.residual is plain.residual
    assert worse.nuisance == pytest.approx(plain.nuisance)


def test_a_whole_mode_a_channel_and_a_tolerance() -> None:
    plain = comparison(1)
    assert Outlier(mode=3).data(plain).sum() == 1 + ROWS
    assert Outlier(source=1).data(plain).sum() == MODES
    wide = with_outliers(plain, [Outlier(tolerance=0, scale=3.0)])
    assert wide.nuisance[:, 0] == pytest.approx(3 * plain.nuisance[:, 0])
    assert wide.variance == pytest.approx(plain.variance)


def test_every_outlier_costs_the_same_and_none_nothing() -> None:
    assert log_price(()) == 0
    assert log_price([Outlier(mode=1)]) < -5
    assert log_price([Outlier(mode=1), Outlier(source=2)]) == pytest.approx(2 * log_price([Outlier(mode=1)]))


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), mode=st.integers(0, MODES - 1))
def test_a_frequency_twelve_sigma_off_is_suspected_first(seed: int, mode: int) -> None:
    found = suspects(comparison(seed, off={mode: 12.0}), 1.0, 2)
    assert {(one.mode, one.channel) for one in found} & {(mode, 0)}


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), row=st.integers(0, ROWS - 1))
def test_a_bad_channel_is_suspected_first(seed: int, row: int) -> None:
    off = {MODES + MODES * row + m: 7.0 * (-1) ** m for m in range(MODES)}
    assert suspects(comparison(seed, off=off), 1.0, 1)[0].source == row


@settings(max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_the_order_is_that_of_leaving_each_frequency_out(seed: int) -> None:
    """Each residual over its deviation, from a fit to all other data, by brute force."""
    plain = comparison(seed)
    found = [one.mode for one in suspects(plain, 1.0, 100) if one.channel == 0 and one.source is None]
    size = []
    for m in range(MODES):
        keep = np.arange(len(plain.residual)) != m
        j, r = plain.nuisance[keep], plain.residual[keep]
        spread = np.linalg.inv(np.eye(2) + j.T @ j)
        expected = plain.nuisance[m] @ (spread @ (j.T @ r))
        deviation = 1 + plain.nuisance[m] @ spread @ plain.nuisance[m]
        size.append((plain.residual[m] - expected) ** 2 / deviation)
    assert found == np.argsort(size)[::-1].tolist()


def test_a_datum_is_odd_from_four_sigma_on() -> None:
    """Where the price and the gain of the best scale balance."""
    for sigmas, odd in ((3.5, False), (4.8, True)):
        plain = replace(comparison(1), nuisance=np.zeros((MODES + MODES * ROWS, 2)))
        plain.residual[:] = 0.0
        plain.residual[0] = sigmas
        start = marginal(plain).log_likelihood
        tried = [[one] for one in Outlier(mode=0, channel=0).scaled()]
        best = max(marginal(with_outliers(plain, one)).log_likelihood + log_price(one) for one in tried)
        assert (best > start) == odd


def test_what_is_about_the_same_data_is_no_further_outlier() -> None:
    frequency = Outlier(mode=2, channel=0, scale=3.0)
    assert frequency.about_the_same(Outlier(mode=2, channel=0, scale=100.0))
    assert not frequency.about_the_same(Outlier(mode=3, channel=0, scale=3.0))
    assert Outlier(tolerance=1).about_the_same(Outlier(tolerance=1))


def test_an_outlier_is_as_much_more_in_doubt_by_the_idealisation() -> None:
    doubtful = replace(comparison(1), idealised=np.full(MODES * (1 + ROWS), 0.5))
    worse = with_outliers(doubtful, [Outlier(mode=2, channel=0, scale=10.0)])
    assert worse.idealised is not None
    assert worse.idealised / worse.variance == pytest.approx(np.full(MODES * (1 + ROWS), 0.5))
