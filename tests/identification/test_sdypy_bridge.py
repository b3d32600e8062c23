"""Exchange with sdypy-EMA, and its poles as an independent check of ours."""

from __future__ import annotations

import warnings

import numpy as np
import pandas as pd
import pytest
from identification_cases import bench, column, lines, structure

from acquisition import Dof, EstimationError, FrfSet, InputError
from identification import beside, from_sdypy, identify, mac, second_opinion, to_sdypy
from identification.sdypy_bridge import opinion_warnings


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
    assert modes.scaled
    np.testing.assert_allclose(np.abs(modes.shapes), np.abs(model.modal.shapes), rtol=1e-6)


def test_a_model_without_modes_is_refused(case):
    _, frfs, model = case
    other = to_sdypy(model)
    del other.A
    with pytest.raises(InputError, match="call get_constants first"):
        from_sdypy(other, frfs)


@pytest.mark.long
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


def test_poles_and_residues_handed_over_make_the_same_frfs(case):
    _, _, model = case
    other = to_sdypy(model)
    s = 2j * np.pi * other.freq
    poles = 2 * np.pi * other.nat_freq * (-other.nat_xi + 1j * np.sqrt(1 - other.nat_xi**2))
    terms = [a[:, None] / (s - p) for a, p in ((other.A[:, r], poles[r]) for r in range(len(poles)))]
    mirror = [
        a.conj()[:, None] / (s - p.conj()) for a, p in ((other.A[:, r], poles[r]) for r in range(len(poles)))
    ]
    whole = s**2 * (sum(terms) + sum(mirror) + other.LR[:, None] / s**2 + other.UR[:, None])
    np.testing.assert_allclose(whole, other.H, atol=0.02 * np.abs(other.H).max())


def test_several_references_come_back_scaled(rng):
    truth = structure((60.0, 140.0, 210.0), (0.01, 0.008, 0.006), 6, seed=12)
    pairs = column(6) + column(6, reference=2)
    frfs = truth.frfs(lines(low=10.0, high=300.0), pairs, noise=0.001, rng=rng)
    modes = from_sdypy(to_sdypy(identify(frfs)), frfs)
    assert modes.scaled
    np.testing.assert_allclose(np.abs(modes.shapes), np.abs(truth.shapes), atol=0.02)


def test_it_is_said_when_its_answer_is_known_to_be_unreliable(case):
    _, frfs, _ = case
    assert opinion_warnings(frfs, (50.0, 300.0)) == ()
    assert second_opinion(frfs, band=(50.0, 300.0), order=20).attrs["warnings"] == ()
    cut = frfs.band(100.0, 300.0)
    assert "loses and shifts modes" in opinion_warnings(cut, (100.0, 300.0))[0]
    assert "loses and shifts" in second_opinion(cut, band=(100.0, 300.0), order=20).attrs["warnings"][0]


def test_a_band_from_zero_is_given_without_its_first_line(rng):
    truth = structure((60.0, 140.0, 210.0), (0.01, 0.008, 0.006), 6, seed=12)
    frfs = truth.frfs(lines(low=0.0, high=300.0), column(6), noise=0.001, rng=rng)
    table = second_opinion(frfs, band=(0.0, 300.0), order=30)
    for hertz in truth.hertz:
        assert np.abs(table["frequency [Hz]"] / hertz - 1).min() < 1e-3


def test_both_opinions_stand_side_by_side_and_neither_is_lost(rng):
    truth = structure((60.0, 110.0, 170.0), (0.01, 0.008, 0.006), 6, seed=31)
    model = identify(truth.frfs(lines(high=250.0), column(6), noise=0.01, rng=rng))
    opinion = pd.DataFrame({"frequency [Hz]": [60.1, 109.9, 200.0], "damping [%]": [1.0, 0.8, 2.0]})
    table = beside(model.modal, opinion)
    theirs = table["sdypy-EMA frequency [Hz]"].to_numpy()
    np.testing.assert_allclose(theirs, [60.1, 109.9, np.nan, 200.0])
    ours = table["frequency [Hz]"].to_numpy()
    np.testing.assert_allclose(ours, [60.0, 110.0, 170.0, np.nan], rtol=1e-3)


@pytest.mark.parametrize("lines", [8, 31, 62])
def test_few_lines_are_asked_for_no_higher_order_than_they_carry(lines):
    """Its LSCF reads impulse responses at more delays than so few lines give."""
    table = second_opinion(few_lines(lines), band=(1.0, float(lines)))
    (note,) = [text for text in table.attrs["warnings"] if "up to order" in text] if lines < 62 else [""]
    assert (f"{lines} lines allow no more" in note) == (lines < 62)


def test_too_few_lines_for_a_second_opinion_are_refused():
    with pytest.raises(EstimationError, match=r"order of 60 on 4 lines; it needs an order of 4 and 7 lines"):
        second_opinion(few_lines(4), band=(1.0, 4.0))


def few_lines(lines):
    """Return one FRF of a mode at 5 Hz on lines 1 Hz apart from 1 Hz on, with noise."""
    frequency = np.arange(1.0, lines + 1)
    s, omega = 2j * np.pi * frequency, 2 * np.pi * 5.0
    noise = 0.01 * np.random.default_rng(0).standard_normal(lines)
    values = s**2 / (s**2 + 0.04 * omega * s + omega**2) + noise
    return FrfSet(frequency, values[None], (Dof(1, 3),), (Dof(1, 3),))
