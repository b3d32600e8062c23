"""Pairing of test modes with model modes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.errors import InputError
from identification import mac, pair

BEAM = np.array([10.0, 62.7, 175.5, 343.9, 568.5])


def indices(pairs):
    return [(p.test, p.model) for p in pairs]


@settings(max_examples=30)
@given(st.floats(0.45, 1.6), st.permutations(range(6)), st.integers(0, 1000))
def test_shapes_pair_through_a_common_factor_and_any_order(factor, order, seed):
    rng = np.random.default_rng(seed)
    test = np.array([50.0, 80.0, 81.0, 140.0, 220.0, 300.0])
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    noisy = shapes + 0.05 * rng.standard_normal(shapes.shape)
    column = list(order)
    found = pair(test, test[column] * factor, mac(noisy, shapes[:, column]))
    assert indices(found) == [(i, column.index(i)) for i in range(6)]
    np.testing.assert_allclose([p.error for p in found], factor - 1, atol=1e-12)


@pytest.mark.parametrize("factor", [0.6, 0.8, 1.0, 1.25, 1.6])
def test_frequencies_alone_keep_the_order(factor):
    assert indices(pair(BEAM, BEAM * factor)) == [(i, i) for i in range(5)]


def test_gaps_on_either_side():
    assert indices(pair(BEAM[[0, 1, 3, 4]], BEAM * 0.9)) == [(0, 0), (1, 1), (2, 3), (3, 4)]
    assert indices(pair(BEAM, BEAM[[0, 1, 3, 4]] * 1.1)) == [(0, 0), (1, 1), (3, 2), (4, 3)]


def test_no_partner_is_an_answer():
    matrix = np.array([[0.95, 0.1, 0.0], [0.1, 0.2, 0.1], [0.0, 0.1, 0.97]])
    found = pair([100.0, 150.0, 200.0], [104.0, 155.0, 207.0], matrix)
    assert indices(found) == [(0, 0), (2, 2)]
    assert found[0].mac == 0.95


def test_equal_shapes_are_parted_by_frequency():
    matrix = np.full((2, 2), 0.9)
    assert indices(pair([100.0, 300.0], [105.0, 310.0], matrix)) == [(0, 0), (1, 1)]


def test_best_assignment_beats_the_greedy_one():
    matrix = np.array([[0.90, 0.85], [0.88, 0.30]])
    assert indices(pair([100.0, 101.0], [100.0, 101.0], matrix)) == [(0, 1), (1, 0)]


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="must be positive"):
        pair([0.0, 10.0], [1.0])
    with pytest.raises(InputError, match=r"MAC matrix has shape \(2, 2\)"):
        pair([5.0, 10.0], [1.0], np.eye(2))
    assert pair([], [1.0]) == ()
