"""Lines over levels that the records know to some per cent: without bias, and as far off as they say."""

from __future__ import annotations

import numpy as np
import pytest

from identification.levels.effective import EffectiveLevels, effective_levels
from identification.levels.slopes import BENT, _slopes

COMMON = 1.8


def drawn(rng: np.random.Generator, error: float) -> tuple[np.ndarray, ...]:
    """Hits at twelve points, of which those are left out that move the modes most."""
    point, level = np.repeat(np.arange(12), 5), rng.lognormal(0.0, 0.6, 60)
    slope, noise = rng.uniform(-0.02, -0.005, 3), np.array([1e-5, 3e-5, 1e-4])
    shifts = slope * level[:, None] + 1e-4 * rng.standard_normal((12, 3))[point]
    shifts += noise * rng.standard_normal(shifts.shape)
    kept = level < 3.0
    recorded = level * np.exp(error * rng.standard_normal(60))
    point = np.unique(point[kept], return_inverse=True)[1]
    return slope, recorded[kept], point, shifts[kept], np.broadcast_to(noise**2, shifts[kept].shape)


def of(rng: np.random.Generator, error: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, EffectiveLevels]:
    slope, recorded, point, shifts, variances = drawn(rng, error)
    plain, _ = _slopes(recorded, COMMON, point, shifts, variances)
    found = effective_levels(recorded, COMMON, point, shifts, variances, plain, bent=BENT)
    fitted, sigma = _slopes(found.levels, COMMON, point, shifts, variances)
    return slope, fitted, np.hypot(sigma, fitted * found.scale_sigma), found


@pytest.mark.long
@pytest.mark.parametrize("error", [0.0, 0.05])
def test_slopes_have_no_bias_and_intervals_hold(error: float) -> None:
    rng = np.random.default_rng(7)
    trials = [of(rng, error) for _ in range(200)]
    pulls = np.array([(fitted - slope) / sigma for slope, fitted, sigma, _ in trials])
    # the modes of a trial share the error of its scale: 200 trials, not 600 modes
    assert abs(pulls.mean()) < 4 * np.sqrt(1 / 200)
    assert np.mean(np.abs(pulls) < 1.96) > 0.95 - 3.5 * np.sqrt(0.95 * 0.05 / 200)
    assert pulls.std() > 0.7, "too wide"


def test_levels_come_nearer_to_the_true_ones_but_for_their_scale() -> None:
    rng = np.random.default_rng(8)
    slope, recorded, point, shifts, variances = drawn(rng, 0.05)
    plain, _ = _slopes(recorded, COMMON, point, shifts, variances)
    found = effective_levels(recorded, COMMON, point, shifts, variances, plain, bent=BENT)

    def beside(levels: np.ndarray) -> float:
        """Return the scatter, within the points, about what the first mode has."""
        parts = [
            np.stack([levels[point == p], shifts[point == p, 0] / slope[0]]).T
            - np.mean([levels[point == p], shifts[point == p, 0] / slope[0]], axis=1)
            for p in range(point.max() + 1)
        ]
        own, true = np.concatenate(parts).T
        return float(np.std(own - (own @ true) / (true @ true) * true))

    assert beside(found.levels) < 0.2 * beside(recorded)


def test_one_mode_alone_leaves_the_recorded_levels() -> None:
    rng = np.random.default_rng(9)
    slope, recorded, point, shifts, variances = drawn(rng, 0.05)
    found = effective_levels(recorded, COMMON, point, shifts[:, :1], variances[:, :1], slope[:1], bent=BENT)
    assert found.levels == pytest.approx(recorded)
    assert found.scale_sigma == 0.0
