"""Two sets of modes with shapes: pairs, modes without a partner, and planes that are turned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.dof import Dof
from acquisition.modal_data import ModalData
from identification import correlate, mac, subspace_mac

HERTZ = np.array([50.0, 80.0, 81.0, 140.0, 220.0, 300.0])


def modes(frequency, shapes=None, nodes=None, sign=1):
    frequency = np.asarray(frequency, dtype=float)
    if shapes is None:
        return ModalData(frequency=frequency, frequency_sigma=np.full(len(frequency), np.nan))
    numbers = range(1, len(shapes) + 1) if nodes is None else nodes
    dofs = tuple(Dof(int(i), sign * 3) for i in numbers)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan),
        dofs=dofs,
        shapes=sign * np.asarray(shapes),
    )


def beam_shapes(n_points, n_modes):
    x = np.linspace(0.05, 0.95, n_points)
    return np.sin(np.pi * np.outer(x, np.arange(1, n_modes + 1)))


def indices(found):
    return [(p.test, p.model) for p in found.pairs]


def turn(shapes, i, j, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    mixed = np.array(shapes, dtype=complex)
    mixed[:, i], mixed[:, j] = c * shapes[:, i] + s * shapes[:, j], c * shapes[:, j] - s * shapes[:, i]
    return mixed


@settings(max_examples=40)
@given(
    st.sets(st.integers(0, 5), min_size=3),
    st.sets(st.integers(0, 5), min_size=3),
    st.lists(st.complex_numbers(min_magnitude=0.1, max_magnitude=10), min_size=6, max_size=6),
    st.permutations(range(6)),
    st.integers(0, 1000),
)
def test_missing_and_extra_modes_on_either_side_in_any_order(kept, known, factors, order, seed):
    rng = np.random.default_rng(seed)
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    noisy = (shapes + 0.02 * rng.standard_normal(shapes.shape)) * np.array(factors)
    ours = [i for i in order if i in kept]
    theirs = sorted(known)
    found = correlate(modes(HERTZ[ours], noisy[:, ours]), modes(HERTZ[theirs] * 1.05, shapes[:, theirs]))
    wanted = {(ours.index(i), theirs.index(i)) for i in kept & known}
    assert set(indices(found)) == wanted
    assert len(found.test_alone) == len(kept - known)
    assert len(found.model_alone) == len(known - kept)
    assert found.subspaces == ()


@pytest.mark.parametrize("degrees", [20.0, 30.0, 45.0, 60.0, 70.0])
def test_a_turned_pair_is_named_and_paired(degrees, rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    noisy = turn(shapes, 1, 2, degrees) + 0.01 * rng.standard_normal(shapes.shape)
    found = correlate(modes(HERTZ, noisy), modes(HERTZ, shapes))
    assert indices(found) == [(i, i) for i in range(6)]
    assert [(s.test, s.model) for s in found.subspaces] == [((1, 2), (1, 2))]
    assert found.subspaces[0].mac > 0.97
    np.testing.assert_allclose(found.pairs[1].mac, np.cos(np.radians(degrees)) ** 2, atol=0.05)
    assert "mixed differently" in found.notes[0]
    assert found.table().loc[1, "mixed with"] == "3"


def test_modes_that_swap_places_are_not_called_mixed(rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    found = correlate(modes(HERTZ, turn(shapes, 1, 2, 90.0)), modes(HERTZ, shapes))
    assert (1, 2) in indices(found)
    assert (2, 1) in indices(found)
    assert found.subspaces == ()


def test_a_turned_pair_far_apart_in_frequency_is_no_pair(rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    found = correlate(modes(HERTZ, turn(shapes, 0, 5, 50.0)), modes(HERTZ, shapes))
    assert found.subspaces == ()
    assert indices(found) == [(i, i) for i in range(1, 5)]


def test_three_turned_modes(rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 4)))[0].astype(complex)
    turned = shapes.copy()
    turned[:, :3] = shapes[:, :3] @ np.linalg.qr(np.array([[1.0, 2, 3], [-2, 1, 1], [0.5, -2, 2]]))[0]
    hertz = [100.0, 101.0, 102.0, 180.0]
    found = correlate(modes(hertz, turned), modes(hertz, shapes))
    assert [s.test for s in found.subspaces] == [(0, 1, 2)]
    assert indices(found) == [(i, i) for i in range(4)]


def test_only_degrees_of_freedom_in_common_are_compared(rng):
    shapes = rng.standard_normal((12, 4))
    hertz = [50.0, 80.0, 120.0, 170.0]
    test = modes(hertz, shapes[:8], nodes=range(1, 9))
    model = modes(hertz, shapes[[11, 6, 5, 4, 3, 2]], nodes=[12, 7, 6, 5, 4, 3], sign=-1)
    found = correlate(test, model)
    assert [d.node for d in found.dofs] == [3, 4, 5, 6, 7]
    np.testing.assert_allclose(np.diag(found.mac), 1.0)
    np.testing.assert_allclose(found.mac, mac(shapes[2:7], shapes[2:7]))


@pytest.mark.parametrize("n_points", [2, 3])
def test_few_points_leave_the_decision_to_frequency(n_points, rng):
    shapes = beam_shapes(n_points, 5)
    hertz = 10.0 * np.arange(1, 6) ** 2
    noisy = shapes + 0.03 * rng.standard_normal(shapes.shape)
    found = correlate(modes(hertz, noisy), modes(hertz * 1.03, shapes))
    assert {i - j for i, j in indices(found)} <= {0}
    assert "a high MAC is weak evidence" in found.notes[-1]


def test_one_point_or_none_in_common_pairs_by_frequency():
    hertz = [10.0, 40.0, 90.0]
    single = correlate(modes(hertz, np.ones((1, 3))), modes(hertz, np.ones((1, 3))))
    strangers = correlate(modes(hertz, np.ones((4, 3))), modes(hertz, np.ones((4, 3)), nodes=range(11, 15)))
    bare = correlate(modes(hertz), modes(hertz[1:]))
    assert indices(single) == indices(strangers) == [(0, 0), (1, 1), (2, 2)]
    assert indices(bare) == [(1, 0), (2, 1)]
    for found in (single, strangers, bare):
        assert np.isnan(found.mac).all()
        assert "paired by frequency alone" in found.notes[0]


def test_a_doubtful_mac_needs_the_frequency_to_agree(rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 4)))[0]
    doubtful = shapes.copy()
    doubtful[:, 3] = (
        np.sqrt(0.6) * shapes[:, 3] + np.sqrt(0.4) * np.linalg.qr(rng.standard_normal((20, 1)))[0][:, 0]
    )
    hertz = np.array([50.0, 80.0, 120.0, 170.0])
    near = correlate(modes(hertz, doubtful), modes(hertz, shapes))
    far = correlate(modes(hertz * [1, 1, 1, 1.8], doubtful), modes(hertz, shapes))
    assert (3, 3) in indices(near)
    assert (3, 3) not in indices(far)
    sure = correlate(modes(hertz * [1, 1, 1, 1.8], shapes), modes(hertz, shapes))
    assert (3, 3) in indices(sure)


def test_the_table_holds_every_mode_once(rng):
    shapes = np.linalg.qr(rng.standard_normal((20, 6)))[0]
    found = correlate(modes(HERTZ[:5], shapes[:, :5]), modes(HERTZ[1:], shapes[:, 1:]))
    table = found.table()
    assert len(table) == 6
    assert table["test"].count() == 5
    assert table["model"].count() == 5
    assert table["test [Hz]"].fillna(table["model [Hz]"]).is_monotonic_increasing


def test_subspace_mac_against_projections(rng):
    a, b = rng.standard_normal((2, 9, 2)) + 1j * rng.standard_normal((2, 9, 2))
    projector = [x @ np.linalg.pinv(x) for x in (a, b)]
    sine = np.linalg.norm(projector[0] - projector[1], ord=2)
    np.testing.assert_allclose(subspace_mac(a, b), 1 - sine**2, atol=1e-12)
    np.testing.assert_allclose(subspace_mac(a[:, :1], b[:, :1]), mac(a[:, 0], b[:, 0])[0, 0])
    np.testing.assert_allclose(subspace_mac(a, a @ rng.standard_normal((2, 2))), 1.0)
    assert np.isnan(subspace_mac(a[:3], b[:3]))
    assert np.isnan(subspace_mac(a[:, [0, 0]], b))
    assert np.isnan(subspace_mac(a, b[:, :1]))


def test_a_mode_that_does_not_move_at_the_common_points_is_like_none():
    """Across the directions measured rounding leaves a shape, here that of another mode."""
    shapes = beam_shapes(9, 3)
    across = np.vstack([1e-12 * shapes[:, 1], np.ones(9)]).reshape(-1)
    model = np.column_stack([np.vstack([shapes, np.zeros_like(shapes)]), across])
    found = correlate(modes(HERTZ[:3], shapes), modes([50.0, 90.0, 81.0, 80.0], model))
    assert indices(found) == [(0, 0), (1, 1), (2, 2)]
    assert (found.mac[:, 3] == 0).all()
