"""How frequencies follow the force of the hits: slopes there and not there, and tests that cannot tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from level_cases import BAND, FREQUENCY, PLAN, SLOPES, struck, structure

from acquisition import HammerPlan, HammerTest, Windows, estimate_frfs, judge_hits
from identification import LevelDependence, identify, level_dependence, why_no_level_dependence
from identification.levels.slopes import _slopes


def found(test: HammerTest, windows: Windows | None = None) -> LevelDependence:
    model = identify(estimate_frfs(test, windows=windows), band=BAND)
    assert len(model) == 4
    dependence = level_dependence(model, [(test, ())], windows=windows)
    assert dependence is not None
    return dependence


@pytest.mark.long
@pytest.mark.parametrize("windows", [None, Windows(decay=3.0)])
def test_slopes_come_out_per_mode(windows: Windows | None) -> None:
    at = structure(SLOPES)
    test, true = struck(at, 3)
    dependence = found(test, windows)
    # levels are the peaks of the records, which the filter before the converter changes by some per cent
    scale = np.sum(dependence.levels * true) / np.sum(true**2)
    assert 0.9 < scale < 1.05
    off = (dependence.slope - SLOPES / scale) / dependence.slope_sigma
    assert np.abs(off).max() < 4
    assert np.abs(SLOPES[[0, 1]] / dependence.slope_sigma[[0, 1]]).min() > 5, (
        "the test is too poor to mean anything"
    )
    assert dependence.weakest < dependence.level < dependence.strongest
    assert dependence.shifts.shape == (16, 4)


@pytest.mark.long
def test_the_shift_of_a_hit_is_that_of_its_frequency() -> None:
    quiet = replace(PLAN, response_noise=1e-4, force_noise=0.0, adc_bits=None, samples=2048)
    test, true = struck(structure(SLOPES), 1, quiet)
    dependence = found(test)
    model = identify(estimate_frfs(test), band=BAND)
    exact = np.log(FREQUENCY) + SLOPES * true[:, None] - np.log(model.modal.frequency)
    assert np.abs(exact).max() > 10 * 2e-4
    assert dependence.shifts == pytest.approx(exact, abs=2e-4)  # a fiftieth of a half-width


@pytest.mark.long
def test_damping_has_a_slope_too() -> None:
    test, true = struck(structure(0.0, damping_slope=4e-5), 2)
    dependence = found(test)
    scale = np.sum(dependence.levels * true) / np.sum(true**2)
    off = (dependence.damping_slope - 4e-5 / scale) / dependence.damping_slope_sigma
    assert np.abs(off).max() < 4
    assert (4e-5 / dependence.damping_slope_sigma).max() > 5


@pytest.mark.long
@pytest.mark.parametrize(("slope", "seeds"), [(0.0, 30), (-2e-5, 12)])
def test_intervals_cover(slope: float, seeds: int) -> None:
    scores = []
    for seed in range(seeds):
        test, true = struck(structure(slope, points=3), 100 + seed)
        dependence = found(test)
        scale = np.sum(dependence.levels * true) / np.sum(true**2)
        scores.append((dependence.slope - slope / scale) / dependence.slope_sigma)
    inside = np.mean(np.abs(scores) < 1.96)
    count = 4 * seeds
    assert inside > 0.95 - 3.5 * np.sqrt(0.95 * 0.05 / count)
    assert np.sqrt(np.mean(np.square(scores))) > 0.7, "too wide"
    assert abs(np.mean(scores)) < 4 / np.sqrt(count), "biased"


@pytest.mark.long
def test_drift_from_point_to_point_is_no_slope() -> None:
    """Points hit harder one after the other while the structure warms up: offsets take it."""
    runs = []
    for i in range(4):
        at = structure(0.0, shift=(0.002 * i,))
        test, _ = struck(at, 20 + i, replace(PLAN, peak=40.0 * (1 + i)))
        runs.append(replace(test, points=test.points[i : i + 1]))
    joined = replace(runs[0], points=tuple(r.points[0] for r in runs))
    dependence = found(joined)
    naive = np.polyfit(dependence.levels, dependence.shifts[:, 1], 1)[0]
    assert naive > 5e-6
    assert np.abs(dependence.slope / dependence.slope_sigma).max() < 4
    assert dependence.slope_sigma[1] < naive


@pytest.mark.long
def test_refused_hits_do_not_count() -> None:
    test, _ = struck(structure(0.0), 4, replace(PLAN, bad={(0, 1): "double", (2, 3): "double"}))
    verdicts = judge_hits(test)
    refused = sum(not v.used for v in verdicts)
    assert refused >= 2
    model = identify(estimate_frfs(test, verdicts=verdicts), band=BAND)
    dependence = level_dependence(model, [(test, verdicts)])
    assert dependence is not None
    assert len(dependence.levels) == 16 - refused


@pytest.mark.parametrize(
    ("plan", "reason"),
    [(replace(PLAN, level_scatter=0.02), "span"), (replace(PLAN, hits=1), "twice or more")],
)
def test_tests_that_cannot_tell_say_why(plan: HammerPlan, reason: str) -> None:
    test, _ = struck(structure(0.0), 5, plan)
    why = why_no_level_dependence([(test, ())])
    assert why is not None
    assert reason in why
    assert level_dependence(identify(estimate_frfs(test), band=BAND), [(test, ())]) is None


@pytest.mark.long
def test_the_level_is_the_one_that_averages_stand_for() -> None:
    """The averaged FRFs of a softening structure have the frequency of the level given, not of the plain mean."""
    test, true = struck(
        structure(-5e-5, points=1), 6, replace(PLAN, hits=12, response_noise=1e-4, level_scatter=0.5)
    )
    model = identify(estimate_frfs(test), band=BAND)
    dependence = level_dependence(model, [(test, ())])
    assert dependence is not None
    stands_for = np.log(model.modal.frequency / FREQUENCY) / -5e-5 * np.mean(dependence.levels / true)
    assert np.median(stands_for) == pytest.approx(dependence.level, rel=0.1)
    assert dependence.level > 1.1 * dependence.levels.mean()


@pytest.mark.parametrize("bend", [0.0, 0.0015])
def test_a_slope_is_that_at_the_level_of_the_averages(bend: float) -> None:
    """Averages stand for hard hits, most hits are softer, and a clamp that gives way moves a mode less and less."""
    rng = np.random.default_rng(3)
    levels, point = rng.lognormal(np.log(60.0), 0.5, 60), np.repeat(np.arange(12), 5)
    common, slope, noise = 110.0, -3e-4, 2e-4
    start = slope * (1 + bend * common) ** 2  # so that the slope at the common level is as it is there
    shifts = start * levels / (1 + bend * levels)
    scatter = noise * rng.standard_normal((60, 40))
    measured, sigma = _slopes(levels, common, point, shifts[:, None] + scatter, np.full((60, 40), noise**2))
    assert np.mean(measured) == pytest.approx(slope, rel=0.03)
    assert np.std(measured) < 1.2 * np.mean(sigma)
    assert np.mean(np.abs(measured - slope) < 1.96 * sigma) > 0.9
