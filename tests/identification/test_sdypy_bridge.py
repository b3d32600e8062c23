"""Exchange with sdypy-EMA, and its poles as an independent check of ours."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from identification_cases import bench, column, lines, structure

from acquisition.errors import InputError
from identification import from_sdypy, identify, mac, second_opinion, to_sdypy


@pytest.fixture
def case(rng):
    truth = structure((60.0, 140.0, 210.0), (0.01, 0.008, 0.006), 6, seed=12)
    frfs = truth.frfs(lines(low=10.0, high=300.0), column(6), noise=0.001, rng=rng)
    return truth, frfs, identify(frfs)


def test_its_own_constants_and_frfs_agree_with_those_handed_over(case):
    _, _, model = case
    other = to_sdypy(model)
    handed, fitted = other.A.copy(), other.H.copy()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other.get_constants()
    np.testing.assert_allclose(other.A, handed, atol=0.01 * np.abs(handed).max())
    np.testing.assert_allclose(other.H, fitted, atol=0.02 * np.abs(fitted).max())


def test_there_and_back(case):
    _, frfs, model = case
    modes = from_sdypy(to_sdypy(model), frfs)
    np.testing.assert_allclose(modes.frequency, model.modal.frequency)
    np.testing.assert_allclose(modes.damping, model.modal.damping)
    np.testing.assert_allclose(np.diag(mac(modes.shapes, model.modal.shapes)), 1.0, rtol=1e-9)
    assert np.isnan(modes.frequency_sigma).all()
    assert not modes.scaled


def test_a_model_without_modes_is_refused(case):
    _, frfs, model = case
    other = to_sdypy(model)
    del other.A
    with pytest.raises(InputError, match="call get_constants first"):
        from_sdypy(other, frfs)


def test_ours_are_closer_to_the_truth_than_its_best_poles(rng):
    truth = bench()
    frfs = truth.frfs(lines(), column(), noise=0.01, rng=rng)
    wanted = truth.poles[:12]
    ours = np.abs(identify(frfs, band=(10.0, 1000.0)).poles / wanted - 1)
    table = second_opinion(frfs, band=(10.0, 1000.0), order=100)
    nearest = np.abs(table["frequency [Hz]"].to_numpy()[:, None] - truth.hertz[:12]).argmin(axis=0)
    chosen = table.iloc[nearest]
    ratio = chosen["damping [%]"].to_numpy() / 100
    theirs = 2 * np.pi * chosen["frequency [Hz]"].to_numpy() * (-ratio + 1j * np.sqrt(1 - ratio**2))
    error = np.abs(theirs / wanted - 1)
    assert np.median(error) < 1e-3
    assert np.median(ours) < np.median(error) / 3


def test_order_of_the_chart_is_the_polynomial_order(case):
    _, frfs, _ = case
    few = second_opinion(frfs, band=(10.0, 300.0), order=4)
    assert len(few) <= 2
