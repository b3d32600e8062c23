"""How far an effect's idealisation may be off in each mode: summed over, from the most to next to nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.thresholds import DOUBT_SHARES

MODES, NOISE = 6, 1e-3


def comparison(residual: np.ndarray, shift: float, *, size: float = 0.05) -> Comparison:
    """Frequencies of an effect that shifts them so far; its own size makes up for errors of the whole shift."""
    each = np.full(MODES, 0.05 * shift)
    return Comparison(
        residual=residual,
        nuisance=np.full((MODES, 1), size),
        variance=NOISE**2 + each**2,
        channel=np.zeros(MODES, dtype=int),
        mode=np.arange(MODES),
        source=np.full(MODES, -1),
        predictions=(),
        scale_prior=(1.0,),
        doubts=np.arange(0),
        tolerances=np.arange(0),
        idealised=each**2,
    )


def test_a_doubt_settled_at_nothing_leaves_noise_and_what_the_size_makes_up_for() -> None:
    one = comparison(np.zeros(MODES), 0.4)
    bare = one.settled(0.0)
    assert bare.variance == pytest.approx(NOISE**2)
    assert bare.nuisance == pytest.approx(one.nuisance)
    assert bare.idealised is None
    assert bare.settled(0.1) is bare
    assert one.settled(1.0).variance == pytest.approx(one.variance)
    assert marginal(bare).share == 1


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), size=st.floats(0.06, 0.6))
def test_an_effect_that_is_just_so_loses_little_by_a_doubt_it_has_no_need_of(seed: int, size: float) -> None:
    """At the most the doubt may be, it loses the factor of a noise many times too large, once for each mode."""
    noise = np.random.default_rng(seed).normal(size=MODES) * NOISE
    noise *= min(1.0, NOISE * np.sqrt(MODES) / np.linalg.norm(noise))
    summed = comparison(noise, size)
    least = marginal(summed.settled(min(DOUBT_SHARES))).log_likelihood
    assert marginal(summed).log_likelihood > least - np.log(len(DOUBT_SHARES))
    if size >= 0.2:
        assert marginal(summed).share == min(DOUBT_SHARES)
        assert marginal(summed).log_likelihood > marginal(summed.settled(1.0)).log_likelihood + 2


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), size=st.floats(0.2, 0.6))
def test_an_effect_that_is_far_from_just_so_loses_the_number_of_sizes(seed: int, size: float) -> None:
    """A misfit as large as the doubt: the most it may be is the most probable."""
    uneven = 0.05 * size * np.random.default_rng(seed).permutation([-1.2, -0.9, -0.3, 0.4, 0.8, 1.2])
    summed = comparison(uneven, size)
    full = marginal(summed.settled(1.0)).log_likelihood
    assert marginal(summed).share == 1
    assert marginal(summed).log_likelihood >= full - np.log(len(DOUBT_SHARES))


def test_no_share_is_left_out_of_the_sum() -> None:
    summed = comparison(np.array([3, -3, 3, -3, 3, -3]) * NOISE, 0.1)
    each = [marginal(summed.settled(share)).log_likelihood for share in DOUBT_SHARES]
    assert marginal(summed).log_likelihood == pytest.approx(np.log(np.mean(np.exp(each))))
    assert marginal(replace(summed, idealised=None)).log_likelihood == pytest.approx(each[0])
