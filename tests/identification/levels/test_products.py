"""Peaks that a joint makes of two modes are not modes: against structures with a joint, integrated in time."""

from __future__ import annotations

import numpy as np
import pytest
from identification_cases import column, lines, structure
from joint_cases import cantilever, joint_test
from level_cases import BAND, struck
from level_cases import structure as softening

from acquisition import estimate_frfs
from identification import coincidences, combination, growth, identify, level_dependence
from identification.levels.products import SURE, _fitted, _Point

SLIP = -2e10
"""Frequencies fall by 0.7 % between the softest and the hardest hit."""


@pytest.fixture(scope="module")
def slipping():
    joint = cantilever(SLIP)
    test = joint_test(joint, 0)
    return joint, test, identify(estimate_frfs(test), band=(15.0, 750.0))


@pytest.mark.long
def test_constants_of_products_grow_with_the_force_those_of_modes_do_not(slipping) -> None:
    joint, test, model = slipping
    tests = [(test, ())]
    grown = growth(model, tests, level_dependence(model, tests))
    assert grown is not None
    near = np.abs(model.modal.frequency[:, None] / joint.frequency - 1.0).min(axis=1) < 0.01
    assert near.sum() == 3
    assert (~near).sum() >= 6  # peaks at sums and differences, as an average shows them
    assert np.array_equal(grown.products, ~near)
    assert np.abs(grown.power[near]).max() < 0.05
    assert grown.power[~near] == pytest.approx(
        np.ones((~near).sum()), abs=0.35
    )  # the joint's force goes as u^2


@pytest.mark.long
@pytest.mark.parametrize("slope", [0.0, -1e-4, 1e-4])
def test_constants_of_modes_that_follow_the_force_do_not_grow(slope: float) -> None:
    for seed in range(3):
        test, _ = struck(softening(slope), seed)
        model = identify(estimate_frfs(test), band=BAND)
        grown = growth(model, [(test, ())], level_dependence(model, [(test, ())]))
        assert grown is not None
        assert not grown.products.any(), (slope, seed)


def test_sums_of_two_come_before_sums_of_three() -> None:
    sources, off = np.array([34.4, 216.2, 606.3]), np.array([0.2, 0.5, 1.0])
    assert combination(285.0, sources, off) == "2 x 34.40 Hz + 216.2 Hz"
    assert combination(390.0, sources, off) == "606.3 Hz - 216.2 Hz"
    assert combination(424.4, sources, off) == "34.40 Hz + 606.3 Hz - 216.2 Hz"
    assert combination(500.0, sources, off) is None


def test_without_hits_sums_are_named_as_what_may_be() -> None:
    hertz = (34.4, 216.2, 606.3, 285.0, 147.4, 537.5, 675.1)
    truth = structure(hertz, (0.004,) * 7, 8, seed=1)
    truth.shapes[:, 3:] *= 0.1
    model = identify(
        truth.frfs(lines(low=15.0, high=750.0), column(8), noise=0.0005, rng=np.random.default_rng(0))
    )
    named = coincidences(model)
    assert sorted(round(float(model.modal.frequency[i]), 1) for i in named) == sorted(hertz[3:])
    other = structure((34.4, 216.2, 606.3, 290.0, 180.0, 501.0, 711.0), (0.004,) * 7, 8, seed=1)
    model = identify(
        other.frfs(lines(low=15.0, high=750.0), column(8), noise=0.0005, rng=np.random.default_rng(0))
    )
    assert not coincidences(model)


@pytest.mark.parametrize("hits", [2, 3, 5])
def test_the_standard_deviation_of_a_growth_is_that_which_occurs(hits: int) -> None:
    """Noise of single FRFs falls with the force; the mean constant of each of twenty points costs a hit."""
    rng, modes, points = np.random.default_rng(hits), 2000, []
    for _ in range(20):
        levels = 12.0 * np.exp(0.3 * rng.standard_normal(hits))
        own, noise = (rng.standard_normal((2, n, 1, modes)) for n in (1, hits))
        scatter = 0.3 * 12.0 / levels[:, None, None] * (noise[0] + 1j * noise[1])
        points.append(_Point.of(own[0] + 1j * own[1] + scatter, levels, np.ones((1, modes))))
    grown = _fitted(points)
    assert np.std(grown.power / grown.sigma) < 1.15
    assert np.mean(grown.power > SURE * grown.sigma) < 0.006
