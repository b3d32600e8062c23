"""Hits of different levels brought to one: against the same structure hit equally hard."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from level_cases import BAND, FREQUENCY, PLAN, struck, structure

from acquisition import HammerTest, Windows, estimate_frfs
from identification import (
    LevelDependence,
    ModalModel,
    at_one_level,
    identify,
    is_smeared,
    level_dependence,
    stretched_averages,
)
from identification.levels.one_level import hits_damping

LOSS, LEVEL = 0.005, PLAN.peak
SLOPE = np.array([-0.05, -0.04, -0.03, -0.03]) / LEVEL
"""Frequencies scatter by three half-widths over hits that scatter by 40 %."""
LONG = replace(PLAN, samples=4096, hits=5)
QUIET = replace(LONG, response_noise=1e-4, force_noise=0.0, adc_bits=None)


def softening(seed: int) -> tuple[HammerTest, np.ndarray]:
    return struck(structure(SLOPE, points=6, damping=LOSS), seed, QUIET)


def identified(test: HammerTest, windows: Windows | None = None) -> ModalModel:
    return identify(estimate_frfs(test, windows=windows), band=BAND)


def brought(test: HammerTest, windows: Windows | None = None) -> tuple[ModalModel, LevelDependence]:
    """Modes of hits brought to one level, and how they follow it."""
    tests = [(test, ())]
    stretched = stretched_averages(identified(test, windows), tests, windows=windows)
    start = identify(stretched.frfs, band=BAND)
    slope = stretched.slopes_at(start.modal.frequency)
    found = level_dependence(start, tests, windows=windows, slope=slope)
    assert found is not None
    (even,) = at_one_level(start, tests, found, windows=windows)
    return identified(even, windows), found


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 4, 5, 8])
def test_averages_are_smeared_and_stretched_ones_show_every_mode(seed: int) -> None:
    """A mode may still show twice, by rounding: what is brought to one level from there has each once."""
    test, _ = softening(seed)
    plain = identified(test)
    found = level_dependence(plain, [(test, ())])
    assert found is not None
    assert is_smeared(plain, found)
    assert len(plain) != 4 or plain.modal.damping.max() > 1.3 * LOSS
    stretched = stretched_averages(plain, [(test, ())])
    start = identify(stretched.frfs, band=BAND)
    every = np.log(start.modal.frequency[:, None] / (FREQUENCY * np.exp(SLOPE * found.level)))
    nearest = np.abs(every).argmin(axis=0)
    assert len(set(nearest.tolist())) == 4
    assert np.abs(every[nearest, np.arange(4)]).max() < LOSS
    assert stretched.slopes_at(start.modal.frequency[nearest]) == pytest.approx(SLOPE, rel=0.1)
    assert len(brought(test, None)[0]) == 4


@pytest.mark.long
@pytest.mark.parametrize("windows", [None, Windows(decay=1.0)])
def test_brought_to_one_level_they_are_those_of_a_structure_hit_equally_hard(windows: Windows | None) -> None:
    test, true = softening(4)
    model, found = brought(test, windows)
    assert len(model) == 4
    assert model.modal.damping == pytest.approx(np.full(4, LOSS), rel=0.01)
    # levels are the peaks of the records, which the filter before the converter changes by some per cent
    level = found.level * np.sum(true**2) / np.sum(true * found.levels)
    assert model.modal.frequency == pytest.approx(FREQUENCY * np.exp(SLOPE * level), rel=0.05 * LOSS)
    plan = replace(QUIET, level_scatter=0.0)
    linear = structure(np.log(model.modal.frequency / FREQUENCY) / LEVEL, points=6, damping=LOSS)
    equal = identified(struck(linear, 8, plan)[0], windows)
    size = np.sqrt(np.mean(np.abs(equal.constants) ** 2, axis=0))
    assert np.abs((model.constants - equal.constants) / size).max() < 0.02


@pytest.mark.long
def test_what_does_not_follow_the_level_stays_as_it_is() -> None:
    test = struck(structure(0.0, points=6, damping=LOSS), 5, LONG)[0]
    model = identified(test)
    found = level_dependence(model, [(test, ())])
    assert found is not None
    assert not is_smeared(model, found)
    (even,) = at_one_level(model, [(test, ())], found)
    assert even.rate == test.rate
    for before, after in zip(test.points, even.points, strict=True):
        assert np.array_equal(before.force, after.force)
        assert after.motion == pytest.approx(before.motion, abs=1e-9 * np.abs(before.motion).max())


@pytest.mark.long
def test_inputs_are_left_as_they_are() -> None:
    test, _ = softening(3)
    copies = [p.motion.copy() for p in test.points]
    brought(test)
    assert all(np.array_equal(p.motion, copy) for p, copy in zip(test.points, copies, strict=True))


def test_hits_that_do_not_show_a_mode_do_not_rule_its_damping() -> None:
    """Three points at an antinode, six at nodes: the six are off by whatever their noise gives."""
    shown = np.repeat([True, False], [6, 12])
    rng = np.random.default_rng(1)
    sigma = np.where(shown, 1e-5, 0.1)[:, None]
    nothing = np.zeros((18, 1))
    found = LevelDependence(
        slope=np.zeros(1),
        slope_sigma=np.ones(1),
        damping_slope=np.zeros(1),
        damping_slope_sigma=np.ones(1),
        level=50.0,
        weakest=30.0,
        strongest=70.0,
        levels=np.linspace(30, 70, 18),
        point=np.arange(18) // 2,
        shifts=nothing,
        sigmas=nothing + 1e-5,
        damping_shifts=1e-3 + sigma * rng.standard_normal((18, 1)),
        damping_sigmas=sigma,
    )
    damping, spread = hits_damping(found)
    assert damping == pytest.approx(1e-3, abs=3e-5)
    assert 1e-6 < spread[0] < 1e-4
