"""Doubts of which only the most is judged: each channel's share of it is summed over."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from updating.likelihood.comparison import CHANNELS, Comparison
from updating.likelihood.gaussian import marginal
from updating.thresholds import DOUBT_SHARES

MODES, MOST, NOISE = 6, 0.1, 0.002
DAMPING, PHASE = CHANNELS.index("damping"), CHANNELS.index("phase")


def comparison(damping: np.ndarray, phase: np.ndarray) -> Comparison:
    """Frequencies without a doubt; damping with a level in common; phases of two chains, turned mode by mode."""
    count = 4 * MODES
    nuisance = np.zeros((count, 2 + MODES))
    nuisance[:MODES, 0] = 1e-3
    nuisance[MODES : 2 * MODES, 1] = MOST
    nuisance[2 * MODES :, 2:] = 0.03 * np.tile(np.eye(MODES), (2, 1))
    judged = np.repeat([0.0, MOST, 0.01, 0.01], MODES) ** 2
    return Comparison(
        residual=np.concatenate([np.full(MODES, 1e-3), damping, phase, phase]),
        nuisance=nuisance,
        variance=NOISE**2 + judged,
        channel=np.repeat([CHANNELS.index("frequency"), DAMPING, PHASE, PHASE], MODES),
        mode=np.tile(np.arange(MODES), 4),
        source=np.full(count, -1),
        predictions=(),
        scale_prior=(1.0,),
        doubts=np.arange(0),
        tolerances=np.arange(0),
        judged=judged,
        judged_columns=np.arange(2 + MODES) >= 2,
    )


def scatter(size: float, seed: int = 0) -> np.ndarray:
    drawn = np.random.default_rng(seed).normal(size=MODES)
    return size * drawn / drawn.std()


def test_every_share_of_every_channel_is_summed_over() -> None:
    one = comparison(scatter(0.03), scatter(0.005, 1))
    each = [
        marginal(one.channels_settled([(DAMPING, a), (PHASE, b)])).log_likelihood
        for a, b in product(DOUBT_SHARES, DOUBT_SHARES)
    ]
    assert marginal(one).log_likelihood == pytest.approx(np.log(np.mean(np.exp(each))))


@pytest.mark.parametrize("share", DOUBT_SHARES)
def test_the_share_is_what_the_data_scatter_by(share: float) -> None:
    found = marginal(comparison(scatter(share * MOST), scatter(0.003)))
    assert dict(found.judged)[DAMPING] == share


def test_the_most_probable_share_gives_chi_squared_and_nuisances() -> None:
    one = comparison(scatter(0.01), scatter(0.003, 1))
    found = marginal(one)
    settled = marginal(found.settle(one))
    assert found.chi2 == pytest.approx(settled.chi2)
    assert found.shift == pytest.approx(settled.shift)
    assert found.count == settled.count


def test_data_as_bad_as_judged_count_nearly_as_if_that_were_known() -> None:
    one = comparison(scatter(MOST), np.zeros(MODES))
    known = marginal(one.channels_settled([(PHASE, dict(marginal(one).judged)[PHASE])]))
    summed = marginal(replace(one, judged=np.where(one.channel == DAMPING, one.judged, 0.0)))
    assert summed.log_likelihood > marginal(one.channels_settled()).log_likelihood - np.log(len(DOUBT_SHARES))
    assert known.log_likelihood >= marginal(one.channels_settled()).log_likelihood


def test_a_channel_that_shares_a_nuisance_keeps_the_most() -> None:
    one = comparison(scatter(0.005), scatter(0.003))
    joined = one.beside(np.zeros((len(one.residual), 0)), np.where(one.channel < 2, 1e-3, 0.0)[:, None])
    found = marginal(joined)
    assert [channel for channel, _ in found.judged] == [PHASE]
    settled = joined.channels_settled(found.judged)
    assert found.chi2 == pytest.approx(marginal(settled).chi2)


def test_data_left_out_have_no_share() -> None:
    one = comparison(scatter(0.01), scatter(0.003))
    found = marginal(one, one.channel != DAMPING)
    assert [channel for channel, _ in found.judged] == [PHASE]
    assert found.count == 3 * MODES
    assert marginal(one, one.of("damping")).count == MODES
