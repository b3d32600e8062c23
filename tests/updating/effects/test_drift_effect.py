"""A drift over the test: what it takes, what it moves, and whether a diagnosis names it and lets others alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank, case_of, specimen, struck

from updating import LIBRARY, Measured, Predictor, diagnose
from updating.effects import accepted_state
from updating.effects.obstacles import Lack
from updating.thresholds import UNREMARKABLE_TREND

EFFECT = LIBRARY["drift"]
OFFERED = [LIBRARY[name] for name in ("drift", "E", "clamp_rotation", "sensor_mass", "time_delay")]


def with_trend(test: Measured, rate: float, sigma: float, rng: np.random.Generator) -> Measured:
    """The same test, its hammer going from point to point while frequencies drift about those it finds."""
    n = len(test.frequency)
    return replace(test, trend=rate + sigma * rng.standard_normal(n), trend_sigma=np.full(n, sigma))


def evaluate() -> Predictor:
    return Predictor(BEAM, with_trend(blank(POINTS), 0.0, 1e-5, np.random.default_rng(1)))


def test_it_needs_points_measured_one_after_the_other() -> None:
    for test in (blank(POINTS), replace(evaluate().measured, trend=np.full(2, np.nan))):
        obstacle = EFFECT.obstacle(Predictor(BEAM, test))
        assert obstacle is not None
        assert obstacle.lack is Lack.DATA
        assert "order" in str(obstacle)
    assert EFFECT.obstacle(evaluate()) is None


@given(st.floats(0, 1))
def test_the_prior_has_both_signs_in_equal_parts(u: float) -> None:
    (rate,) = EFFECT.parameters(evaluate())
    value = rate.value(u)
    assert UNREMARKABLE_TREND * (1 - 1e-9) <= abs(value) <= 0.04 * (1 + 1e-9)
    assert (value < 0) == (u < 0.5)


def test_it_moves_no_mode_of_the_test_as_a_whole_and_adds_up() -> None:
    predictor = evaluate()
    state = EFFECT.state(predictor, {"rate": 0.01})
    assert predictor.predict(state, count=4).frequency == pytest.approx(predictor.predict(count=4).frequency)
    assert state.plus(accepted_state(predictor, "drift", {"rate": 0.005})).drift == pytest.approx(0.015)


@pytest.mark.parametrize("rate", [-0.004, pytest.param(0.01, marks=pytest.mark.long)])
def test_a_diagnosis_names_it_with_its_rate(rate: float) -> None:
    rng = np.random.default_rng(8)
    test = with_trend(struck(specimen(rng), rng), rate, 1e-4, rng)
    found = diagnose(case_of(test), library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("drift",),))
    assert found.where.channel == "measurement"
    assert found.shrink.metric == "combined"
    (row, *_) = found.ranking
    stated = row.parameters["drift.rate"]
    assert stated.low95 < rate < stated.high95
    assert stated.value == pytest.approx(rate, rel=0.25)


@pytest.mark.parametrize("rate", [4e-4, pytest.param(0.0, marks=pytest.mark.long)])
def test_what_a_laboratory_does_in_an_hour_is_no_gap(rate: float) -> None:
    rng = np.random.default_rng(8)
    test = with_trend(struck(specimen(rng), rng), rate, 2e-5, rng)
    found = diagnose(case_of(test), library=OFFERED)
    assert found.verdict == "none"
    assert not found.significant


@pytest.mark.long
def test_no_drift_acquits_it_and_does_not_keep_another_from_being_named() -> None:
    rng = np.random.default_rng(9)
    test = with_trend(struck(specimen(rng, E=0.9), rng), 1e-4, 1e-5, rng)
    found = diagnose(case_of(test), library=[EFFECT, LIBRARY["E"], LIBRARY["sensor_mass"]])
    assert found.sets == (("E",),)


@pytest.mark.long
def test_it_is_named_beside_another() -> None:
    rng = np.random.default_rng(9)
    test = with_trend(struck(specimen(rng, E=0.9), rng), -0.006, 1e-4, rng)
    found = diagnose(case_of(test), library=[EFFECT, LIBRARY["E"], LIBRARY["sensor_mass"]])
    assert set(found.sets[0]) == {"E", "drift"}
    assert len(found.sets) == 1
