"""A joint that gives with the force: prior, obstacle, and whether a diagnosis names it and lets others alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank, case_of, specimen, struck

from updating import LIBRARY, Measured, Predictor, diagnose

LEVEL = 80.0
EFFECT = LIBRARY["joint_nonlinearity"]


def with_slopes(test: Measured, slope: float, sigma: float, rng: np.random.Generator) -> Measured:
    """The same test by hits of different levels: frequencies are those at the level that averages stand for."""
    n = len(test.frequency)
    return replace(
        test,
        frequency=test.frequency * (1 + slope * LEVEL),
        slope=slope + sigma * rng.standard_normal(n),
        slope_sigma=np.full(n, sigma),
        level=LEVEL,
    )


def evaluate() -> Predictor:
    return Predictor(BEAM, with_slopes(blank(POINTS), 0.0, 1e-6, np.random.default_rng(1)))


def test_it_needs_hits_of_different_levels() -> None:
    assert "2 : 1" in str(EFFECT.obstacle(Predictor(BEAM, blank(POINTS))))
    assert EFFECT.obstacle(evaluate()) is None
    nothing = replace(evaluate().measured, slope=np.full(2, np.nan))
    assert EFFECT.obstacle(Predictor(BEAM, nothing)) is not None


@given(st.floats(0, 1))
def test_the_prior_has_both_signs_in_equal_parts(u: float) -> None:
    slope, _ = EFFECT.parameters(evaluate())
    value = slope.value(u)
    assert slope.low <= value <= slope.high
    assert 1e-4 / LEVEL * (1 - 1e-9) <= abs(value) <= 0.2 / LEVEL * (1 + 1e-9)
    assert (value < 0) == (u < 0.5)
    assert value == pytest.approx(-slope.value(1 - u)) or u == 0.5
    assert slope.coordinate(value) == pytest.approx(u, abs=1e-9)


def test_frequencies_follow_slope_and_level() -> None:
    predictor = evaluate()
    state = EFFECT.state(predictor, {"slope": -2e-4})
    ratio = predictor.predict(state, count=4).frequency / predictor.predict(count=4).frequency
    assert ratio == pytest.approx(np.full(4, 1 - 2e-4 * LEVEL))


@pytest.mark.parametrize("slope", [-1e-4, pytest.param(1e-4, marks=pytest.mark.long)])
def test_a_diagnosis_names_it(slope: float) -> None:
    rng = np.random.default_rng(8)
    test = with_slopes(struck(specimen(rng), rng), slope, 4e-6, rng)
    library = [LIBRARY[n] for n in ("joint_nonlinearity", "E", "clamp_rotation", "sensor_mass")]
    found = diagnose(case_of(test), library=library)
    assert found.sets == (("joint_nonlinearity",),)
    (row, *_) = found.ranking
    stated = row.parameters["joint_nonlinearity.slope"]
    assert stated.low95 < slope < stated.high95


@pytest.mark.long
def test_slopes_that_are_none_acquit_it() -> None:
    rng = np.random.default_rng(9)
    test = with_slopes(struck(specimen(rng, E=0.9), rng), 0.0, 4e-6, rng)
    found = diagnose(case_of(test), library=[EFFECT, LIBRARY["E"], LIBRARY["sensor_mass"]])
    assert found.sets == (("E",),)


@pytest.mark.long
def test_a_slope_per_newton_is_no_better_known_than_the_force() -> None:
    """The data hold slope times force alone: a hammer 3 % off makes a slope 3 % off, with nothing to show it."""
    rng = np.random.default_rng(8)
    test = with_slopes(struck(specimen(rng), rng), -1e-4, 1e-7, rng)
    widths = []
    for calibration in (0.001, 0.03):
        found = diagnose(case_of(replace(test, calibration=calibration)), library=[EFFECT])
        slope = found.ranking[0].parameters["joint_nonlinearity.slope"]
        assert slope.low95 is not None
        assert slope.high95 is not None
        widths.append((slope.high95 - slope.low95) / abs(float(slope.value)))
    assert widths[1] >= 2 * 1.96 * 0.03
    assert widths[0] < widths[1]
