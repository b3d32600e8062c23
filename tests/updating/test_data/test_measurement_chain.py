"""What a faulty measurement reads is what a sound one reads elsewhere, under other names, by other factors."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, PLATE, POINTS, blank

from updating import Measured, Predictor
from updating.models.state import State
from updating.test_data.chain import measurement_chain

GRID = np.array([[x, y] for x in (0.1, 0.22, 0.376) for y in (0.0, 0.09, 0.2)])
TESTS = {"beam": Predictor(BEAM, blank(POINTS)), "plate": Predictor(PLATE, blank(GRID))}
both = pytest.mark.parametrize("name", list(TESTS))


def constants(predictor: Predictor, state: State = State()) -> np.ndarray:  # noqa: B008
    return predictor.predict(state, count=4).constants


def roved(test: Measured) -> Measured:
    return replace(test, seen=test.hit, hit=test.seen)


@both
def test_a_sound_test_reads_its_own_points(name: str) -> None:
    test = TESTS[name].measured
    read = measurement_chain(test, State())
    assert np.array_equal(read.seen, test.seen)
    assert np.array_equal(read.hit, test.hit)
    assert np.array_equal(read.gain, np.ones(len(test.seen)))
    assert np.array_equal(read.points, test.points)


@both
def test_exchanged_labels_exchange_rows(name: str) -> None:
    found = constants(TESTS[name], State(exchanged=(("hit", 0, 2),)))
    rows = np.arange(len(found))
    rows[[0, 2]] = 2, 0
    assert found == pytest.approx(constants(TESTS[name])[rows], rel=1e-12)
    twice = State(exchanged=(("hit", 0, 2), ("hit", 0, 2)))
    assert constants(TESTS[name], twice) == pytest.approx(constants(TESTS[name]), rel=1e-12)


@both
def test_a_reversed_point_reverses_its_own_rows_only(name: str) -> None:
    found = constants(TESTS[name], State(point_gains={("hit", 1): -1.0}))
    signs = np.ones(len(found))
    signs[1] = -1.0
    assert found == pytest.approx(signs[:, None] * constants(TESTS[name]), rel=1e-12)
    test = TESTS[name].measured
    everywhere = measurement_chain(test, State(gain=2.0, point_gains={("seen", int(test.seen[0])): 0.5}))
    assert everywhere.gain == pytest.approx(np.ones(len(test.seen)))


@both
@settings(max_examples=10)
@given(away=st.floats(-0.02, 0.02))
def test_a_point_that_moved_reads_as_one_stated_there(name: str, away: float) -> None:
    here = TESTS[name]
    dim = here.measured.points.shape[1]
    shift = np.array([away, 0.5 * abs(away)])[:dim]
    places = here.measured.points.copy()
    places[1] += shift
    there = here.for_test(replace(here.measured, points=places))
    moved = State(moved={("hit", 1): tuple(shift)})
    assert constants(here, moved) == pytest.approx(constants(there), rel=1e-9, abs=1e-9)
    assert here.predict(moved, count=4).along == pytest.approx(
        there.predict(count=4).along, rel=1e-9, abs=1e-9
    )


@both
def test_moving_the_hammer_leaves_the_sensor_at_the_same_point(name: str) -> None:
    here = TESTS[name]
    last = len(here.measured.points) - 1
    moved = State(moved={("hit", last): (-0.01, 0.0)})
    found, plain = constants(here, moved), constants(here)
    assert found[:last] == pytest.approx(plain[:last], rel=1e-12)
    assert np.abs(found[last] / plain[last] - 1).max() > 0.01


@both
def test_the_end_that_roves_is_told(name: str) -> None:
    test = TESTS[name].measured
    assert test.roving == "hit"
    assert roved(test).roving == "seen"


def test_shapes_alone_are_seen() -> None:
    assert blank(POINTS, shapes_only=True).roving == "seen"
