"""When a hit was given, whatever noise a long record of its force holds."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import Dof, estimate_frfs, hammer_test
from acquisition.hits.impulse import impulse_places
from acquisition.synthetic import HammerPlan, ModalSystem, modal_system


def one_mode() -> ModalSystem:
    shape = np.array([[1.0]])
    return modal_system(
        frequency=np.array([60.0]),
        damping=np.array([0.005]),
        response_shapes=shape,
        point_shapes=shape,
        responses=[Dof(1, 3)],
        points=[Dof(1, 3)],
    )


@pytest.mark.parametrize("noise", [0.0, 0.3, 2.0])
def test_noise_of_a_long_record_does_not_move_the_hit(noise: float) -> None:
    rng = np.random.default_rng(1)
    time = np.arange(20000.0)
    force = 100.0 * np.exp(-0.5 * ((time - 200.3) / 2.0) ** 2) + noise * rng.standard_normal((20, 20000))
    assert np.abs(impulse_places(force) - 200.3).max() < 0.01 + noise


def test_a_pulse_upside_down_at_the_start_of_a_record_has_its_place() -> None:
    time = np.arange(500.0)
    force = 3.0 - 100.0 * np.exp(-0.5 * ((time - 3.0) / 1.5) ** 2)
    assert impulse_places(force[None])[0] == pytest.approx(3.0, abs=0.2)


def test_the_record_of_frfs_has_the_hit_where_it_was() -> None:
    plan = HammerPlan(rate=2048.0, samples=4096, force_noise=1.0, pre_trigger=0.01, width=1e-3)
    frfs = estimate_frfs(hammer_test(one_mode(), plan, rng=np.random.default_rng(3)))
    assert frfs.record is not None
    assert frfs.record.trigger == pytest.approx(0.01 + 0.0005 + 0.5 / 2048, abs=5e-4)


def test_a_sharp_filter_leaves_the_records_silent_behind_the_pulse() -> None:
    plan = HammerPlan(rate=2048.0, samples=2048, width=1e-3, adc_bits=None, anti_alias="sharp")
    force = hammer_test(one_mode(), plan, rng=np.random.default_rng(0)).points[0].force
    assert np.abs(force[:, 256:]).max() < 1e-5 * np.abs(force).max()
