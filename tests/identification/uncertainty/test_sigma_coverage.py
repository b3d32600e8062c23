"""Do 95 % intervals hold the truth 95 times in a hundred?"""

from __future__ import annotations

import numpy as np
import pytest
from identification_cases import bench, column, lines

from identification import identify


def scores(seeds, *, above, low=0.0, colour=None, n_points=25, noise=0.01):
    """Errors over sigmas of ln f, damping and the real part of the constants, pooled."""
    frequency, damping, constants = [], [], []
    for seed in seeds:
        truth = bench(seed=seed, above=above, n_points=n_points)
        frfs = truth.frfs(
            lines(), column(n_points), noise=noise, rng=np.random.default_rng(7000 + seed), colour=colour
        )
        model = identify(frfs, band=(low, 1000.0))
        wanted = truth.within(low, 1000.0)
        assert len(model) == wanted.sum()
        sigma = np.sqrt(model.pole_covariance[:, [0, 1], [0, 1]])
        frequency.append(np.log(model.modal.frequency / truth.hertz[wanted]) / sigma[:, 0])
        damping.append((model.modal.damping - truth.damping[wanted]) / sigma[:, 1])
        exact = truth.shapes[:, wanted] * truth.shapes[3, wanted]
        constants.append(((model.constants.real - exact) / model.constant_sigma).ravel())
    return [np.concatenate(x) for x in (frequency, damping, constants)]


@pytest.mark.long
@pytest.mark.parametrize("above", [True, False])
def test_sigmas_are_neither_too_small_nor_too_large(above):
    for score in scores(range(8), above=above):
        allowed = 3 / np.sqrt(2 * len(score))  # three standard deviations of an r.m.s.
        assert abs(np.sqrt(np.mean(score**2)) - 1) < max(allowed, 0.08)


@pytest.mark.slow
@pytest.mark.parametrize("colour", ["white", "rising", "falling"])
def test_pooled_coverage_over_sixty_seeds(colour):
    x = lines() / 1000.0
    law = {"white": None, "rising": 0.3 + 2.0 * x**2, "falling": 1.5 - 1.3 * x}[colour]
    cases = [(above, low) for above in (True, False) for low in (0.0, 300.0)]
    pooled = [scores(range(60), above=above, low=low, colour=law) for above, low in cases]
    for score in (np.concatenate(kind) for kind in zip(*pooled, strict=True)):
        assert 0.93 < np.mean(np.abs(score) < 1.96) < 0.97
