"""Where several solutions explain the data, value, sigma and interval speak of all of them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from acquisition import ModalData
from updating import Axes, Case, Material, Region, Spec, Tolerances, build_structure, measured_from_modes
from updating.update import bootstrap, update
from updating.update.data.whitening import whitening
from updating.update.statistics.mixture import Mixture, laplace

STEEL = Material(210e9, 7850.0, 0.3)
HALVES = (Region("left", (0.0, 0.2)), Region("right", (0.2, 0.4)))
FREE = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(16,),
    clamped=(),
    theory="euler-bernoulli",
    material=STEEL,
    regions=HALVES,
)


def case_of(spec: Spec, left: float, right: float) -> Case:
    regions = (replace(HALVES[0], E=left * 210e9), replace(HALVES[1], E=right * 210e9))
    values = build_structure(replace(spec, regions=regions)).eigen(8)[0]
    f = np.sqrt(np.maximum(values, 0))[2 if not spec.clamped else 0 :] / (2 * np.pi)
    test = measured_from_modes(
        ModalData(frequency=f, frequency_sigma=1e-4 * f), Axes(), spec, repeatability=0.0
    )
    return Case("bar", spec, test, baseline=None, tolerances=Tolerances({"E": 0.3}))


def test_a_free_beam_of_two_halves_has_its_mirror_image_in_the_interval() -> None:
    result = update(case_of(FREE, 0.7, 1.2), parameters=["left.E", "right.E"])
    assert any("2 solutions" in w and "left.E, right.E" in w for w in result.warnings)
    assert sorted(p.factor or np.nan for p in result.parameters) == pytest.approx([0.7, 1.2], rel=0.01)
    for p in result.parameters:
        assert p.interval is not None
        assert p.interval[0] / 210e9 == pytest.approx(0.7, rel=0.01)
        assert p.interval[1] / 210e9 == pytest.approx(1.2, rel=0.01)
        # the r.m.s. error of a value that is right every other time
        away = np.log(1.2 / 0.7)
        assert p.sigma / p.value == pytest.approx(away / np.sqrt(2), rel=0.02)
    assert result.correlations[0, 1] < -0.99


def test_a_clamped_beam_has_none() -> None:
    result = update(case_of(replace(FREE, clamped=("x0",)), 0.7, 1.2), parameters=["left.E", "right.E"])
    assert not any("solutions" in w for w in result.warnings)
    assert [p.interval for p in result.parameters] == [None, None]
    assert [p.factor for p in result.parameters] == pytest.approx([0.7, 1.2], rel=0.01)


def test_intervals_of_a_bootstrap_hold_both_mirror_images() -> None:
    found = bootstrap(
        case_of(FREE, 0.7, 1.2), parameters=["left.E", "right.E"], n=20, rng=np.random.default_rng(3)
    )
    for p in found.update.parameters:
        assert p.interval is not None
        assert p.interval[0] < 0.71 * 210e9
        assert p.interval[1] > 1.19 * 210e9


def test_quantiles_of_a_mixture_are_those_of_its_distribution_function() -> None:
    mixture = Mixture(np.array([0.7, 0.3]), np.array([[0.0], [4.0]]), np.array([[[1.0]], [[0.25]]]))
    low, high = mixture.interval()[0]
    parts = [(0.7, stats.norm(0, 1)), (0.3, stats.norm(4, 0.5))]
    assert [sum(w * d.cdf(x) for w, d in parts) for x in (low, high)] == pytest.approx([0.025, 0.975])
    assert mixture.error()[0, 0] == pytest.approx(0.7 * 1 + 0.3 * (0.25 + 16))


def test_a_solution_that_costs_more_or_is_sharper_weighs_less() -> None:
    narrow, wide = np.diag([0.01, 0.01]), np.diag([0.04, 0.01])
    mixture = laplace(np.array([0.0, 2.0]), np.zeros((2, 2)), np.stack([narrow, wide]))
    assert mixture.weight[1] / mixture.weight[0] == pytest.approx(2 * np.exp(-1))


def test_whitening_undoes_a_covariance() -> None:
    rng = np.random.default_rng(4)
    sigma, common = rng.uniform(0.5, 2.0, 12), rng.standard_normal((12, 3))
    white = whitening(sigma, common)
    root = white(np.eye(12))
    covariance = np.diag(sigma**2) + common @ common.T
    assert root @ covariance @ root.T == pytest.approx(np.eye(12), abs=1e-12)
    drawn = np.stack([white.draw(rng) for _ in range(20000)])
    assert np.cov(drawn.T) == pytest.approx(covariance, abs=0.05 * covariance.max())
