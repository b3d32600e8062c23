"""Frequencies that change from point to point in measuring order: the trend, its sigma, and what is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import lines, structure

from acquisition.frfs.frf import FrfSet
from identification import ModalModel, identify
from identification.fit.course import _clarities, course_of
from identification.trend import _lines

HERTZ, DAMPING, POINTS = np.array([70.0, 150.0, 260.0]), (0.004, 0.003, 0.002), 13
REFERENCE = 4


def joined(parts: list[FrfSet]) -> FrfSet:
    return replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=sum((p.responses for p in parts), ()),
        references=sum((p.references for p in parts), ()),
    )


def roved(
    factors: np.ndarray, seed: int, *, hammer: bool = True, shapes: int = 5, noise: float = 0.005
) -> FrfSet:
    """FRFs measured one after the other, all frequencies, or each of them, times a factor that is the point's own."""
    rng = np.random.default_rng(seed)
    points = len(factors)
    pairs = [(REFERENCE, i + 1) if hammer else (i + 1, REFERENCE) for i in range(points)]
    parts = [
        structure(HERTZ * factor, DAMPING, POINTS, seed=shapes).frfs(
            lines(df=0.25, high=350.0), [pair], noise=noise, rng=rng
        )
        for factor, pair in zip(factors, pairs, strict=True)
    ]
    return joined(parts)


def line(rate: float, points: int = POINTS) -> np.ndarray:
    return 1.0 + rate * np.linspace(-0.5, 0.5, points)


def cut(factors: np.ndarray) -> FrfSet:
    return roved(factors, 1).band(20.0, 340.0)


def found(frfs: FrfSet) -> ModalModel:
    return identify(frfs, band=(20.0, 340.0))


@pytest.mark.long
@pytest.mark.parametrize("rate", [5e-4, -2e-3, 4e-3])
@pytest.mark.parametrize("hammer", [True, False])
def test_a_drift_is_found_with_its_sign_and_the_modes_are_those_of_the_middle(
    rate: float, hammer: bool
) -> None:
    model = found(roved(line(rate), 3, hammer=hammer))
    trend = model.trend
    assert trend is not None
    assert trend.setups == POINTS
    assert trend.rate == pytest.approx(rate, abs=4 * trend.rate_sigma + 0.01 * abs(rate))
    assert trend.rate_sigma < 0.02 * abs(rate)
    np.testing.assert_allclose(trend.value, rate, rtol=0.05)
    np.testing.assert_allclose(model.modal.frequency, HERTZ, rtol=0.3 * abs(rate))
    assert any("frequencies drift" in w and f"last of {POINTS} points" in w for w in model.warnings)


@pytest.mark.long
def test_without_drift_the_trend_is_none_within_its_sigma() -> None:
    trends = [found(roved(line(0.0), seed)).trend for seed in range(8)]
    scores = np.array([t.rate / t.rate_sigma for t in trends if t is not None])
    assert len(scores) == 8
    assert np.abs(scores).max() < 3.0
    assert 0.3 < np.sqrt(np.mean(scores**2)) < 1.7


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_what_each_point_has_of_its_own_widens_the_sigma_and_is_no_trend(seed: int) -> None:
    scatter = 1.0 + 1e-3 * np.random.default_rng(20 + seed).standard_normal(POINTS)
    trend = found(roved(scatter, seed)).trend
    assert trend is not None
    assert abs(trend.rate) < 3 * trend.rate_sigma
    assert 5e-4 < trend.rate_sigma < 3e-3  # 1e-3 over 13 points, 12 / 13 of them squared


@pytest.mark.long
@pytest.mark.parametrize(("rate", "shapes"), [(0.0, 5), (0.0, 6), (1e-3, 5)])
def test_the_mass_of_a_roving_sensor_is_no_trend(rate: float, shapes: int) -> None:
    """It lowers each mode by its square where the sensor sits, the more the further out it goes."""
    square = structure(HERTZ, DAMPING, POINTS, seed=shapes).shapes ** 2
    loaded = line(rate)[:, None] * (1.0 - 2e-3 * square / square.mean(axis=0))
    trend = found(roved(loaded, 1, hammer=False, shapes=shapes)).trend
    assert trend is not None
    assert trend.rate == pytest.approx(rate, abs=3 * trend.rate_sigma)
    assert trend.rate_sigma < 1e-3


@pytest.mark.long
def test_one_mode_that_shifts_alone_is_no_drift_of_all() -> None:
    factors = np.stack([line(0.0), line(0.0), line(4e-3)], axis=1)
    trend = found(roved(factors, 2)).trend
    assert trend is not None
    np.testing.assert_allclose(trend.value[:2], 0.0, atol=1e-4)
    assert trend.value[2] == pytest.approx(4e-3, rel=0.05)


def test_a_test_that_does_not_rove_has_none() -> None:
    both = roved(line(0.0, 2), 1)
    assert found(both).trend is None
    assert found(roved(line(0.0, 3), 1)).trend is not None
    assert found(roved(line(0.0, 3), 1, hammer=False)).trend is None  # a line, and the sensor's mass


@pytest.mark.long
@pytest.mark.parametrize("rate", [0.02, -0.035])
def test_a_drift_of_many_widths_makes_no_rows_of_modes(rate: float) -> None:
    model = found(roved(line(rate), 4))
    assert len(model) == 3, model.table()
    np.testing.assert_allclose(model.modal.frequency, HERTZ, rtol=5e-4)
    np.testing.assert_allclose(model.modal.damping, DAMPING, rtol=0.2)
    assert model.trend is not None
    assert model.trend.rate == pytest.approx(rate, rel=0.05)


def test_a_drift_is_sought_in_the_spectra_only_where_peaks_do_not_overlap() -> None:
    assert course_of(cut(line(0.0))) is None
    assert course_of(cut(line(1e-3))) is None
    assert course_of(cut(line(0.02, 3))) is None
    course = course_of(cut(line(0.02)))
    assert course is not None
    np.testing.assert_allclose(course, line(0.02) - 1.0, atol=1e-3)


@pytest.mark.parametrize(("rate", "shapes"), [(-0.005, 2), (0.004, 5)])
def test_a_drift_wider_than_sharp_peaks_and_narrower_than_broad_ones_loses_no_mode(
    rate: float, shapes: int
) -> None:
    """A fit finds the shifts of broad peaks; a sharp one beside them was a row of peaks, lost or 8e-4 off."""
    hertz = np.array([40.0, 75.0, 120.0, 180.0, 240.0, 300.0])
    damping = (0.0005, 0.004, 0.0008, 0.003, 0.0006, 0.0035)
    rng = np.random.default_rng(1)
    parts = [
        structure(hertz * factor, damping, POINTS, seed=shapes).frfs(
            lines(df=0.2, high=350.0), [(REFERENCE, i + 1)], noise=0.005, rng=rng
        )
        for i, factor in enumerate(line(rate))
    ]
    model = found(joined(parts))
    assert len(model) == len(hertz), model.table()
    np.testing.assert_allclose(model.modal.frequency, hertz, rtol=3e-4)
    assert model.trend is not None
    assert model.trend.rate == pytest.approx(rate, rel=0.02)


def test_the_clarity_of_a_rate_is_the_power_of_the_sum_of_moved_rows() -> None:
    rng = np.random.default_rng(2)
    peaks = np.zeros((5, 400))
    peaks[:, 100:300] = rng.random((5, 200))
    rates = np.array([-40, -4, 0, 8, 40])
    for rate, power in zip(rates, _clarities(peaks, rates), strict=True):
        moved = [np.roll(row, -(rate * i // 4)) for i, row in enumerate(peaks)]
        assert power == pytest.approx(np.sum(np.sum(moved, axis=0) ** 2), rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("points", [3, 4, 6])
def test_chance_hardly_makes_a_plain_drift_of_few_points(points: int) -> None:
    """Scatter from point to point, of which each is sure: three points have one spare, whose tails are long."""
    rng = np.random.default_rng(points)
    design = np.tile(np.stack([np.ones(points), np.linspace(-0.5, 0.5, points)], axis=1), (1, 1, 1))
    plain = 0
    for _ in range(2000):
        slope, sigma, common = _lines(
            1e-3 * rng.standard_normal((1, points)), np.full((1, points), 1e-12), design
        )
        plain += bool(abs(slope[0]) > 4 * np.hypot(sigma[0], common))
    assert plain < 12


def test_a_course_that_bends_tilts_no_mode_against_the_others() -> None:
    """Each mode shows at points of its own; what all do together beside a line is none's alone."""
    rng, points, modes = np.random.default_rng(4), 14, 6
    place = np.linspace(-0.5, 0.5, points)
    ratios, apart = [], []
    for _ in range(200):
        shape = np.cos(np.pi * np.arange(1, modes + 1)[:, None] * (place + rng.random()))
        noise = 3e-6 / np.maximum(np.abs(shape), 0.03)
        course = 1e-4 * (np.cos(2 * np.pi * (place + rng.random())) + 2 * place**2)
        shifts = course + noise * rng.standard_normal((modes, points))
        design = np.tile(np.stack([np.ones(points), place], axis=1), (modes, 1, 1))
        value, sigma, _ = _lines(shifts, noise**2, design)
        weight = sigma**-2.0
        away = value - weight @ value / weight.sum()
        ratios.append(np.mean((away / sigma) ** 2))
        apart.append(np.median(np.abs(away)))
    assert 0.4 < np.mean(ratios) < 1.3
    assert np.mean(apart) < 6e-6  # 7.9e-6 where the course stays in the slope of each mode
