"""The noise of hits fades along the record as the window on it does, whether that is stated or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, estimate_frfs
from acquisition.synthetic import HammerPlan, hammer_test, modal_system
from identification import identify
from identification.fading import Fading

HERTZ, ZETA = np.array([31.0, 68.0, 127.0, 171.0]), np.array([0.006, 0.004, 0.003, 0.005])
PLAN = HammerPlan(
    rate=512.0, samples=2048, hits=5, peak=80.0, width=4e-3, anti_alias="sharp", force_noise=1e-3, response_noise=1e-3
)  # fmt: skip


def identified(decay: float, *, stated: float, seed: int = 0) -> Fading | None:
    rng = np.random.default_rng(seed)
    shapes = rng.standard_normal((8, len(HERTZ)))
    system = modal_system(
        frequency=HERTZ, damping=ZETA, response_shapes=shapes[:1], point_shapes=shapes, responses=[Dof(1, 3)],
        points=[Dof(i + 1, 3) for i in range(8)],
    )  # fmt: skip
    test = hammer_test(system, replace(PLAN, decay=decay), rng=rng)
    return identify(estimate_frfs(replace(test, decay=stated), band=(10.0, 190.0))).fading


@pytest.mark.long
@pytest.mark.parametrize("decay", [0.0, 0.4, 1.0, 3.0])
@pytest.mark.parametrize("part", [1.0, 0.0])
def test_noise_fades_as_the_window_stated_or_not(decay: float, part: float) -> None:
    off = []
    for seed in range(3):
        fading = identified(decay, stated=part * decay, seed=seed)
        assert fading is not None
        left = (1 - part) * decay
        off.append((fading.log_ratio - fading.expected(left)) / fading.sigma(left))
        if left >= 1.0:  # and no other decay does
            assert abs(fading.log_ratio - fading.expected()) > 5 * fading.sigma()
    assert np.sqrt(np.mean(np.square(off))) < 1.7


@pytest.mark.long
def test_frfs_without_hits_show_no_fading() -> None:
    rng = np.random.default_rng(1)
    system = modal_system(
        frequency=HERTZ, damping=ZETA, response_shapes=rng.standard_normal((2, 4)),
        point_shapes=rng.standard_normal((3, 4)), responses=[Dof(1, 3), Dof(2, 3)],
        points=[Dof(i + 1, 3) for i in range(3)],
    )  # fmt: skip
    frfs = estimate_frfs(hammer_test(system, replace(PLAN, decay=1.0), rng=rng), band=(10.0, 190.0))
    assert identify(replace(frfs, variance=None, averages=None)).fading is None


@pytest.mark.parametrize("duration", [1.0, 8.0])
def test_more_decay_makes_a_larger_ratio_up_to_what_lines_show(duration: float) -> None:
    fading = Fading(0.0, 1000, duration, 0.0)
    ratios = [fading.expected(fade / duration) for fade in (0.0, 1.0, 3.0, 10.0, 40.0, 80.0)]
    assert ratios[0] == 0.0
    assert np.all(np.diff(ratios[:-1]) > 0)
    assert ratios[-1] == ratios[-2]
    assert Fading(0.0, 1000, duration, 3.0).expected(2.0) == pytest.approx(fading.expected(5.0))
