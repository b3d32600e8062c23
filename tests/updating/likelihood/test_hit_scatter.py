"""The scatter of hits is separated: where they were, how loud they were, and noise of each constant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from updating_cases import BEAM, blank, exactly

from identification.hit_errors import HitErrors
from updating import Measured, Predictor
from updating.likelihood.hit_scatter import HitScatter, hit_scatter, level_errors, own_variance
from updating.prediction.prediction import Prediction

HITS, POINTS, MODES = 5, 12, 5


def drawn(
    rng: np.random.Generator, place: float, gain: float, white: float, *, stated: float = 1.0
) -> tuple[Measured, Prediction, NDArray[np.float64]]:
    """Draw a roving test whose hits miss their points, differ in gain and have noise; and the noise of each."""
    points = np.linspace(0.1, 1.0, POINTS) * BEAM.length
    test = replace(blank(points), seen=np.full(POINTS, POINTS - 1), hit=np.arange(POINTS))
    predictor = Predictor(BEAM, test)
    truth = predictor.predict(count=MODES)
    size = np.sqrt(np.mean(truth.constants**2, axis=0))
    own = white * size * np.ones_like(truth.constants)
    away, louder = (s * rng.standard_normal((POINTS, HITS, 1)) for s in (place, gain))
    each = (
        away * truth.along[0][:, None, :]
        + louder * truth.constants[:, None, :]
        + np.sqrt(HITS) * own[:, None, :] * rng.standard_normal((POINTS, HITS, MODES))
    )
    # what each hit adds to the error of the mean: the sum of products is its covariance
    deviations = (each - each.mean(axis=1, keepdims=True)) / np.sqrt(HITS * (HITS - 1))
    errors = HitErrors(
        deviations, np.full(POINTS, HITS - 1.0), stated * own, np.arange(POINTS), np.ones(MODES)
    )
    return replace(exactly(predictor, truth, sigma=1e-3), hit_errors=errors), truth, own


def found(test: Measured, truth: Prediction) -> HitScatter:
    scatter = hit_scatter(test, truth)
    assert scatter is not None
    return scatter


@pytest.mark.long
@settings(max_examples=15)
@given(
    seed=st.integers(0, 10**6),
    place=st.sampled_from([3e-4, 1e-3, 3e-3]),
    gain=st.sampled_from([3e-3, 1e-2]),
    stated=st.sampled_from([0.3, 1.0, 4.0]),
)
def test_each_part_is_found_whatever_the_weights_state(
    seed: int, place: float, gain: float, stated: float
) -> None:
    test, truth, own = drawn(np.random.default_rng(seed), place, gain, 5e-4, stated=stated)
    scatter = found(test, truth)
    # 48 degrees of freedom: a standard deviation errs by a tenth
    assert scatter.place * np.sqrt(HITS) == pytest.approx(np.full(POINTS, place), rel=0.45)
    assert scatter.gain * np.sqrt(HITS) == pytest.approx(np.full(POINTS, gain), rel=0.45)
    assert scatter.white == pytest.approx(own, rel=0.5)


@pytest.mark.long
def test_hits_that_only_are_noisy_say_little_of_places() -> None:
    places = []
    for seed in range(10):
        test, truth, own = drawn(np.random.default_rng(seed), 0.0, 0.0, 1e-3)
        scatter = found(test, truth)
        assert scatter.white == pytest.approx(own, rel=0.35)
        places.append(scatter.place[0] * np.sqrt(np.mean(truth.along[0] ** 2, axis=0)))
    # what is left to chance is a part of the noise itself
    assert np.mean(places, axis=0) == pytest.approx(np.zeros(MODES), abs=0.5 * float(own.max()))


def test_the_sizes_have_the_unit_of_the_constants() -> None:
    test, truth, _ = drawn(np.random.default_rng(7), 1e-3, 5e-3, 5e-4)
    hits = test.hit_errors
    assert hits is not None
    times = replace(hits, deviations=1e3 * hits.deviations, white=1e3 * hits.white)
    louder = replace(test, constants=1e3 * test.constants, hit_errors=times)
    plain, scaled = found(test, truth), found(louder, truth)
    assert scaled.white == pytest.approx(1e3 * plain.white, rel=1e-6)
    assert scaled.place == pytest.approx(plain.place, rel=1e-6)
    assert scaled.gain == pytest.approx(plain.gain, rel=1e-6)


def test_the_order_of_points_and_the_sign_of_a_sensor_change_nothing() -> None:
    test, truth, _ = drawn(np.random.default_rng(3), 1e-3, 5e-3, 5e-4)
    plain = found(test, truth)
    hits = test.hit_errors
    assert hits is not None
    order = np.random.default_rng(0).permutation(POINTS)
    mixed = replace(test, constants=-test.constants[order], hit_errors=hits.rows(order), hit=test.hit[order])
    turned = replace(
        truth, constants=truth.constants[order], hit=truth.hit[order], hit_slopes=truth.hit_slopes[:, order]
    )
    there = found(mixed, turned)
    assert there.white == pytest.approx(plain.white[order], rel=1e-6)
    assert there.place == pytest.approx(plain.place[order], rel=1e-6)


def test_few_modes_do_not_tell_a_place_from_noise() -> None:
    test, truth, _ = drawn(np.random.default_rng(5), 1e-3, 5e-3, 5e-4)
    two = np.arange(2)
    assert hit_scatter(test.modes(two), truth.select(two)) is None
    assert hit_scatter(replace(test, hit_errors=None), truth) is None


def test_what_the_hits_do_not_tell_is_taken_as_stated() -> None:
    test, truth, _ = drawn(np.random.default_rng(5), 1e-3, 5e-3, 5e-4)
    assert own_variance(test, None) == pytest.approx(test.constants_sigma**2)
    assert level_errors(test, None) == pytest.approx(np.zeros(MODES))
    turned = replace(test, quadrature=np.full(MODES, 1.0))
    assert own_variance(turned, found(test, truth)).mean(axis=0) == pytest.approx(np.ones(MODES), rel=0.2)


def test_errors_of_poles_stretch_a_mode_and_leave_its_shape() -> None:
    test, truth, _ = drawn(np.random.default_rng(5), 1e-3, 5e-3, 5e-4)
    scatter = found(test, truth)
    stretched = replace(test, shared=0.01 * test.constants[:, :, None])
    assert level_errors(stretched, scatter) == pytest.approx(np.full(MODES, 0.01))
    assert own_variance(stretched, scatter) == pytest.approx(own_variance(test, scatter))
