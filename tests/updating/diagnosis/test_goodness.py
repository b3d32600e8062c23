"""What the rest of the data predicts of each part: a misfit of a few among many is seen, whatever the noise is."""

import numpy as np
import pytest
from scipy.stats import kstest

from updating.diagnosis.search.goodness import p_value, p_values
from updating.diagnosis.search.points import Point
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.thresholds import REPEATED_SCATTER_PRIOR

MODES, POINTS = 8, 20
SHAPES = MODES * POINTS
MODE = np.concatenate([np.arange(MODES), np.tile(np.arange(MODES), POINTS)])
SOURCE = np.concatenate([np.full(MODES, -1), np.repeat(np.arange(POINTS), MODES)])


def point(seed: int, *, overstated: float = 1.0, off: np.ndarray | None = None) -> Point:
    """Return frequencies and shapes that are as noisy as stated, shapes perhaps less; ``off`` is added in sigma."""
    rng = np.random.default_rng(seed)
    channel = np.repeat([0, 2], [MODES, SHAPES])
    nuisance = rng.standard_normal((MODES + SHAPES, 3)) * np.where(channel == 0, 2.0, 0.3)[:, None]
    noise = rng.standard_normal(MODES + SHAPES) + (0.0 if off is None else off)
    residual = nuisance @ rng.standard_normal(3) + noise / np.where(channel == 2, overstated, 1.0)
    data = Comparison(
        residual=residual, nuisance=nuisance, variance=np.ones(len(residual)), channel=channel, mode=MODE,
        source=SOURCE, predictions=(), scale_prior=REPEATED_SCATTER_PRIOR, doubts=np.arange(0),
        tolerances=np.arange(0),
    )  # fmt: skip
    return Point(np.zeros(0), data, marginal(data))


def test_what_the_rest_predicts_of_frequencies_is_uniform() -> None:
    found = [p_values(point(seed)) for seed in range(60)]
    single = [one[f"frequency {m + 1}"] for one in found for m in range(MODES)]
    assert kstest(single, "uniform").pvalue > 1e-3
    assert kstest([one["frequency"] for one in found], "uniform").pvalue > 1e-3


def test_one_in_twenty_is_below_five_per_cent_at_the_most() -> None:
    found = np.array([p_value(point(seed)) for seed in range(200)])
    assert (found < 0.05).mean() <= 0.05 + 3 * np.sqrt(0.05 * 0.95 / 200)


@pytest.mark.parametrize("overstated", [1.0, 1.3])
@pytest.mark.parametrize("part", ["mode", "channel"])
def test_a_misfit_of_one_mode_or_channel_is_seen_beside_noise_that_is_overstated(
    overstated: float, part: str
) -> None:
    off = 5.0 * ((SOURCE >= 0) & ((MODE if part == "mode" else SOURCE) == 3))
    spoiled, sound = (p_values(point(4, overstated=overstated, off=one)) for one in (off, None))
    assert spoiled[f"shapes of {part} 4"] < 5e-3
    assert spoiled[f"shapes of {part} 4"] < 0.1 * sound[f"shapes of {part} 4"]
    others = [value for name, value in spoiled.items() if name.startswith(f"shapes of {part}")]
    assert sorted(others)[1] > 0.01


def test_data_that_a_state_does_not_predict_are_no_part() -> None:
    plain = point(1)
    idle = np.zeros(len(MODE), dtype=bool)
    idle[MODES + 5 * MODES : MODES + 6 * MODES] = True
    whole, less = (
        p_values(Point(plain.coordinates, data, plain.marginal))
        for data in (plain.comparison, plain.comparison.__class__(**{**vars(plain.comparison), "idle": idle}))
    )
    assert set(whole) - set(less) == {"shapes of channel 6"}
