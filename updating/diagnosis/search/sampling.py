"""Samples of the posterior and the evidence, by adaptive multiple importance sampling.

The proposals are a mixture: the prior itself, and a t-distribution about every maximum. So it is right for a maximum at
an end of the prior, for several maxima, and for a parameter the data do not see, where a Laplace approximation is not.
All samples of all rounds are weighted by the whole mixture that they were drawn from (Veach and Guibas 1995, SIGGRAPH,
419-428; Cornuet, Marin, Mira and Robert 2012, Scandinavian Journal of Statistics 39, 798-812). Each round fits the
mixture to them by a step of expectation and maximisation (Cappe, Douc, Guillin, Marin and Robert 2008, Statistics and
Computing 18, 447-459). What samples of the prior hold of the weight becomes a component of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc
from scipy.stats import t as student

from acquisition.arrays import FloatArray
from updating.diagnosis.search.fit import Peak
from updating.thresholds import ENOUGH_SAMPLES, MOST_SAMPLES, PRIOR_SHARE, SAMPLE_FREEDOM, UNSEEN_CURVATURE


@dataclass(frozen=True, eq=False)
class Mixture:
    """Proposals in the unit cube of prior quantiles: the prior, and t-distributions.

    Parameters
    ----------
    shares : (c,) array
        Of the t-distributions; the rest is the prior's [-].
    means : (c, k) array
        Their middles [-].
    factors : (c, k, k) array
        Lower factors that independent t-variates are taken through [-].
    """

    shares: FloatArray
    means: FloatArray
    factors: FloatArray

    def draw(self, count: int, *, seed: int) -> FloatArray:
        """Return what of ``count`` samples is inside the cube, (m, k) [-]; outside of it the prior is nil.

        Samples outside weigh nothing and count among those drawn.
        """
        cube = qmc.Sobol(self.means.shape[1], seed=seed).random(count)
        ends = np.round(count * np.cumsum(self.shares)).astype(int)
        drawn = [cube[ends[-1] :]]
        for part, mean, lower in zip(np.split(cube, ends)[:-1], self.means, self.factors, strict=True):
            # a t-variate of 0 or 1 is infinite
            drawn.append(mean + student.ppf(np.clip(part, 1e-6, 1 - 1e-6), SAMPLE_FREEDOM) @ lower.T)
        samples = np.concatenate(drawn)
        return np.asarray(samples[np.all((samples >= 0) & (samples <= 1), axis=1)])

    def log_parts(self, samples: FloatArray) -> FloatArray:
        """Return the logarithm of each part's density times its share at samples (m, k), (1 + c, m) [-].

        The prior's is the first.
        """
        parts = [np.full(len(samples), np.log1p(-self.shares.sum()))]
        for share, mean, lower in zip(self.shares, self.means, self.factors, strict=True):
            standard = np.linalg.solve(lower, (samples - mean).T)
            size = np.log(np.abs(np.diag(lower))).sum()
            parts.append(np.log(share) + student.logpdf(standard, SAMPLE_FREEDOM).sum(axis=0) - size)
        return np.stack(parts)

    def fitted(
        self,
        samples: FloatArray,
        weights: FloatArray,
        *,
        least_share: float = 0.01,
        least_spread: float = 1e-6,
    ) -> Mixture:
        """Return the mixture after one step of expectation and maximisation, (m, k) samples with weights (m,) [-].

        The step is that of normal components: a t-distribution through the same factor is wider, on the safe side.
        A component that few samples support stays nearly as wide as it was, and no narrower than ``least_spread``;
        one with less than ``least_share`` of the weight goes [-].
        """
        parts = self.log_parts(samples)
        owned = weights * np.exp(parts - np.logaddexp.reduce(parts))
        k = samples.shape[1]
        before = [
            np.cov(samples.T, aweights=owned[0] + 1e-300, ddof=0).reshape(k, k),
            *(f @ f.T for f in self.factors),
        ]
        shares, means, factors = [], [], []
        for own, old in zip(owned, before, strict=True):
            share = float(own.sum())
            if share < least_share:
                continue
            mean = own @ samples / share
            away = samples - mean
            # the covariance of as many samples as these are worth, and k + 1 of the width it had
            number = share**2 / float(np.sum(own**2))
            wide = (number * (away.T * own) @ away / share + (k + 1) * old) / (number + k + 1)
            shares.append(share)
            means.append(mean)
            factors.append(np.linalg.cholesky(wide + least_spread**2 * np.eye(k)))
        whole = np.array(shares) * (1 - PRIOR_SHARE) / sum(shares)
        return Mixture(whole, np.array(means), np.array(factors))


def about(peaks: list[Peak]) -> Mixture:
    """Return the mixture of the prior and of each peak, a little wider than its curvature, all peaks alike."""
    shares = np.full(len(peaks), (1 - PRIOR_SHARE) / len(peaks))
    means = np.array([peak.point.coordinates for peak in peaks])
    return Mixture(shares, means, np.array([_factor(peak) for peak in peaks]))


@dataclass(frozen=True, eq=False)
class Posterior:
    """Samples of the posterior.

    Parameters
    ----------
    log_evidence : float
        Logarithm of the mean likelihood over the prior [-].
    samples : (m, k) array
        Prior quantiles [-].
    weights : (m,) array
        Their weights, summing to 1; to a power below 1 where fewer than :func:`least` samples carry them [-].
    effective : float
        Number of independent samples that the weights are worth, before any power; 0 where no sample is possible [-].
    """

    log_evidence: float
    samples: FloatArray
    weights: FloatArray
    effective: float


def effective(weights: FloatArray) -> float:
    """Return the number of independent samples that weights (m,) summing to 1 are worth [-].

    Kish 1965, Survey Sampling.
    """
    return float(1 / np.sum(weights**2))


def least(parameters: int) -> int:
    """Return how many independent samples the middle and the spread of so many parameters need: twice as many, and two.

    Fewer determine no integral, either: most of it may be where none is.
    """
    return 2 * (1 + parameters)


def enough(parameters: int, share: float = 1.0) -> float:
    """Return the number of independent samples wanted of a posterior with ``share`` of the best one's probability [-].

    The sum of all evidence is known best for its samples where each has as many as its share asks for (Neyman
    1934, Journal of the Royal Statistical Society 97, 558-625);
    what holds a tenth as much as the best has all. None has fewer than twice the :func:`least`.
    """
    return max(ENOUGH_SAMPLES * min(1.0, 10.0 * share), 2.0 * least(parameters))


def draw_posterior(
    log_likelihood: Callable[[FloatArray], FloatArray],
    mixture: Mixture,
    count: int,
    *,
    most: int = MOST_SAMPLES,
    wanted: float = ENOUGH_SAMPLES,
) -> Posterior:
    """Draw from a mixture and from what it is fitted to until enough samples carry the weight.

    Where a handful carries it in the end, its spread is not that of the posterior, and far too narrow. Weights to a
    power below one are those of a wider posterior.

    Parameters
    ----------
    log_likelihood : callable
        Of samples (m, k), (m,) [-].
    mixture : Mixture
        What is drawn from first.
    count : int
        Samples drawn in each round, a power of two: Sobol points are even only then.
    most : int
        Most samples in all rounds.
    wanted : float
        As how many independent samples they are to be worth [-].
    """
    drawn: list[Mixture] = []
    samples, height = np.zeros((0, mixture.means.shape[1])), np.zeros(0)
    while True:
        new = mixture.draw(count, seed=1 + len(drawn))
        samples, height = np.concatenate([samples, new]), np.concatenate([height, log_likelihood(new)])
        drawn.append(mixture)
        # samples of all rounds have the weights of one mixture of all proposals: a bad early one does no harm
        density = np.logaddexp.reduce(np.concatenate([one.log_parts(samples) for one in drawn]))
        log_weight = height - density - np.log(count)
        total = float(np.logaddexp.reduce(log_weight))
        if np.isneginf(total):
            return Posterior(total, samples, np.full(len(samples), 1 / len(samples)), 0.0)
        number = effective(np.exp(log_weight - total))
        flat = _flattened(log_weight, least(samples.shape[1]))
        if number >= wanted or (1 + len(drawn)) * count > most:
            return Posterior(total, samples, flat, number)
        mixture = mixture.fitted(samples, flat)


def _flattened(log_weight: FloatArray, wanted: int) -> FloatArray:
    """Return a power of the weights, the first of 1, 1/2, 1/4 ... by which ``wanted`` samples carry it, (m,) [-].

    The power is taken of logarithms: far from a narrow maximum most weights are too small for a number. Where no more
    samples than that are possible, the weights stay as they are: equal ones are worth ``wanted`` up to round-off only.
    """
    height = log_weight - log_weight.max()
    weights = np.exp(height) / np.sum(np.exp(height))
    while effective(weights) < wanted < np.isfinite(height).sum():
        height = height / 2
        weights = np.exp(height) / np.sum(np.exp(height))
    return np.asarray(weights)


def _factor(peak: Peak) -> FloatArray:
    """Return the lower Cholesky factor of the covariance to draw with, (k, k) [-].

    It is a little wider than the peak, no wider than its slope at an edge. A slope that is steep beside a parameter
    which the data do not see leaves variances further apart than the digits of a number hold. So the factor comes from
    a square root by QR (Golub and Van Loan 2013, Matrix Computations, section 5.2), and the covariance is never formed.
    """
    k = len(peak.gradient)
    precision = peak.normal + np.diag(peak.outward**2) + UNSEEN_CURVATURE * np.eye(k)
    values, vectors = np.linalg.eigh((precision + precision.T) / 2)
    # 1.4 of its variance; round-off may leave an eigenvalue below that of what the data do not see
    root = (vectors * np.sqrt(1.4 / np.maximum(values, 1.0))).T
    upper = np.linalg.qr(root).R
    return np.asarray(upper.T * np.where(np.diag(upper) < 0, -1.0, 1.0))
