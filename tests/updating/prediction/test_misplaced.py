"""What misplaced hits and sensors do, beside the shapes of a free beam in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from updating_cases import STEEL, blank, exactly

from updating import Measured, Predictor, Spec
from updating.prediction.misplaced import moved, squared_wave_numbers, stated_levels
from updating.prediction.prediction import Prediction
from updating.update.data.shape_errors import constant_errors

LENGTH, MODES, SIGMA = 1.0, 4, 2e-3
BEAM = Spec(
    "beam",
    length=LENGTH,
    width=0.03,
    thickness=0.01,
    elements=(40,),
    clamped=(),
    theory="euler-bernoulli",
    material=STEEL,
)
MASS = 7850.0 * LENGTH * 0.03 * 0.01
HITS = np.linspace(0.06, 0.94, 12)


def shape(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mass-normalised shapes of a free beam and their slopes, (n, MODES): cosh cos = 1."""
    roots = [
        brentq(lambda s: np.cos(s) - 1 / np.cosh(s), (n + 0.3) * np.pi, (n + 0.7) * np.pi)
        for n in range(1, MODES + 1)
    ]
    b = np.array(roots) / LENGTH
    u, end = np.multiply.outer(x, b), b * LENGTH
    k = (np.cosh(end) - np.cos(end)) / (np.sinh(end) - np.sin(end))
    value = np.cosh(u) + np.cos(u) - k * (np.sinh(u) + np.sin(u))
    slope = b * (np.sinh(u) - np.sin(u) - k * (np.cosh(u) + np.cos(u)))
    return value / np.sqrt(MASS), slope / np.sqrt(MASS)


def node(mode: int) -> float:
    """Node nearest to x = 0."""
    return float(brentq(lambda x: shape(np.array([x]))[0][0, mode], 0.01, 0.3))


def hammer_test(stated: list[float], really: list[float]) -> tuple[Measured, Prediction]:
    """Return a test of 12 hit points whose sensors stand elsewhere than stated, and the model's modes."""
    count = len(stated)
    points = np.append(HITS, stated)
    test = blank(points)
    seen, hit = np.repeat(12 + np.arange(count), 12), np.tile(np.arange(12), count)
    test = replace(test, seen=seen, hit=hit, position_sigma=SIGMA)
    predictor = Predictor(BEAM, test)
    model = predictor.predict(count=MODES)
    test = replace(exactly(predictor, model, sigma=1e-8), position_sigma=SIGMA)
    real = constants(really, HITS)
    return replace(test, constants=real, constants_sigma=np.full(real.shape, 1e-9)), model


def constants(sensors: list[float], hits: np.ndarray) -> np.ndarray:
    at_hits = shape(hits)[0]
    return np.concatenate([shape(np.array([x]))[0] * at_hits for x in sensors])


SENSORS = {
    "away from nodes": ([0.45], [0.45]),
    "on a node of the model, 1 mm off": ([node(1)], [node(1) + 1e-3]),
    "two, one of them on a node": ([0.45, node(1)], [0.45, node(1) - 2e-3]),
}


@pytest.mark.parametrize("name", SENSORS)
def test_slopes_by_places_are_those_of_the_closed_form(name: str) -> None:
    stated, really = SENSORS[name]
    test, model = hammer_test(stated, really)
    by = moved(test, model, stated_levels(test, model), test.constants)
    at_hits, slopes = shape(HITS)
    at_sensors, sensor_slopes = shape(np.array(really))
    size = np.sqrt(np.mean(test.constants**2, axis=0))
    hits = np.concatenate([one * slopes for one in at_sensors])
    sensors = np.concatenate([one * at_hits for one in sensor_slopes])
    assert by.constants / size == pytest.approx(test.constants / size, abs=0.01)
    largest = np.abs(hits / size).max()
    assert by.first[0] / size == pytest.approx(hits / size, abs=0.005 * largest)
    largest = np.abs(sensors / size).max()
    assert by.sensor[0] / size == pytest.approx(sensors / size, abs=0.03 * largest)


@pytest.mark.parametrize("name", SENSORS)
def test_an_update_allots_shapes_the_errors_that_drawn_places_make(name: str) -> None:
    stated, really = SENSORS[name]
    test, model = hammer_test(stated, really)
    whitening = constant_errors(test, model)
    found = np.sqrt(
        np.mean((whitening.sigma**2 + np.sum(whitening.common**2, axis=1)).reshape(-1, 4), axis=0)
    )
    rng, drawn = np.random.default_rng(1), 1500
    errors = [
        constants(
            list(really + SIGMA * rng.standard_normal(len(really))), HITS + SIGMA * rng.standard_normal(12)
        )
        - test.constants
        for _ in range(drawn)
    ]
    # one sensor's error is one draw for all constants of a mode: its r.m.s. over 1500 has a spread of 2 %
    assert found == pytest.approx(np.sqrt(np.mean(np.square(errors), axis=(0, 1))), rel=0.08)


def test_wave_numbers_are_those_of_the_closed_form() -> None:
    test, model = hammer_test([0.45], [0.45])
    at_hits, slopes = shape(HITS)
    expected = np.mean(slopes**2, axis=0) / np.mean(at_hits**2, axis=0)
    assert squared_wave_numbers(test, model)[0] == pytest.approx(expected, rel=2e-3)
