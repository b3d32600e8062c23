"""Samples about peaks: their density is right however unevenly the data know the parameters."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from acquisition.arrays import FloatArray
from updating.diagnosis.search.fit import Peak
from updating.diagnosis.search.points import Point
from updating.diagnosis.search.sampling import about, draw_posterior
from updating.likelihood.gaussian import Marginal


def peak(normal: np.ndarray, place: float = 0.5) -> Peak:
    """A maximum with a given information matrix, in the middle of the unit cube or at some place of its diagonal."""
    middle = np.full(len(normal), place)
    point = Point(middle, None, Marginal(0.0, 0.0, middle, 1, 1.0))  # type: ignore[arg-type]
    return Peak(point, normal, np.zeros(len(normal)))


@pytest.mark.parametrize("information", [1e2, 1e6, 1e16, 1e18, 1e22])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (1.0, -2.0, 0.5), (0.3, 0.3, 0.3)])
def test_densities_integrate_to_one(information: float, direction: tuple[float, ...]) -> None:
    """One combination of three parameters is known, by up to eleven digits, and nothing is of the others."""
    mixture = about([peak(information * np.outer(direction, direction))])
    samples = mixture.draw(4096, seed=1)
    density = np.logaddexp.reduce(mixture.log_parts(samples))
    assert np.isfinite(density).all()
    assert ((samples >= 0) & (samples <= 1)).all()
    assert np.sum(np.exp(-density)) / 4096 == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("k", [1, 2, 5])
@pytest.mark.parametrize("off", [0.0, 1.5])
def test_the_evidence_of_a_known_integral(k: int, off: float) -> None:
    """The first proposal is off by some standard deviations and three times too narrow: the rounds mend it."""
    sigma = 0.03
    truth = multivariate_normal(np.full(k, 0.5), sigma**2 * np.eye(k))
    start = about([peak(np.eye(k) * 9 / sigma**2, 0.5 + off * sigma)])
    found = draw_posterior(lambda u: np.atleast_1d(truth.logpdf(u)), start, min(32 * 2**k, 256))
    assert found.effective > (100 if k < 5 else 20)
    assert found.log_evidence == pytest.approx(0.0, abs=0.25)  # 2.5 standard deviations of 100 samples
    mean = found.weights @ found.samples
    np.testing.assert_allclose(mean, 0.5, atol=sigma * 0.35)
    spread = np.sqrt(found.weights @ (found.samples - mean) ** 2)
    np.testing.assert_allclose(spread, sigma, rtol=0.3)


def test_two_maxima_of_which_one_was_missed() -> None:
    """A second maximum, wide enough for samples of the prior to meet it, holds its half of the evidence."""
    parts = [multivariate_normal(np.full(2, at), 0.04**2 * np.eye(2)) for at in (0.25, 0.75)]
    found = draw_posterior(
        lambda u: np.logaddexp(parts[0].logpdf(u), parts[1].logpdf(u)) - np.log(2),
        about([peak(np.eye(2) / 0.04**2, 0.25)]),
        128,
    )
    assert found.log_evidence == pytest.approx(0.0, abs=0.25)
    assert found.weights[found.samples[:, 0] > 0.5].sum() == pytest.approx(0.5, abs=0.12)


def test_a_likelihood_that_hardly_any_sample_can_bear() -> None:
    """Weights too small for a number are no weights of zero: the rounds end, and near the integral."""

    def narrow(u: np.ndarray) -> np.ndarray:
        return np.where(np.abs(u - 0.9).max(axis=1) < 0.05, 2000.0, -1e4 * ((u - 0.3) ** 2).sum(axis=1))

    found = draw_posterior(narrow, about([peak(np.eye(2) * 1e4, 0.3)]), 64)
    assert found.log_evidence - 2000.0 == pytest.approx(2 * np.log(0.1), abs=1.0)


def test_a_likelihood_of_nothing_has_no_evidence() -> None:
    found = draw_posterior(lambda u: np.full(len(u), -np.inf), about([peak(np.eye(2))]), 64)
    assert found.log_evidence == -np.inf
    assert found.weights.sum() == pytest.approx(1.0)


def test_a_rough_likelihood_does_not_make_narrow_intervals() -> None:
    """A ripple of 40 over a wide maximum: one sample in hundreds is on a crest of it, and carries all the weight."""
    sigma, k = 0.1, 6

    def rippled(u: FloatArray) -> FloatArray:
        wide = multivariate_normal(np.full(k, 0.5), sigma**2 * np.eye(k)).logpdf(u)
        return np.asarray(wide + 40 * np.cos(900 * u.sum(axis=1)) * np.cos(700 * u[:, 0]))

    found = draw_posterior(rippled, about([peak(np.eye(k) / sigma**2, 0.5)]), 256)
    assert found.effective < 10
    spread = np.sqrt(found.weights @ (found.samples - found.weights @ found.samples) ** 2)
    assert (spread > 0.3 * sigma).all()


def test_as_many_possible_samples_as_are_wanted() -> None:
    """Weights of one size are worth their number up to round-off: no power of them is worth more."""
    met = 0

    def log_likelihood(u: FloatArray) -> FloatArray:
        nonlocal met
        heights = np.full(len(u), -np.inf)
        heights[: max(4 - met, 0)] = 0.0
        met += len(u)
        return heights

    found = draw_posterior(log_likelihood, about([peak(np.eye(1) * 1e4)]), 16, most=64)
    assert np.count_nonzero(found.weights) == 4
    assert 0 < found.effective <= 4
