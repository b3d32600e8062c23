"""Modes of hammer tests whose noise is as in reality: common to all outputs of a hit, and drifting between set-ups."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet, estimate_frfs
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
from identification import identify
from identification.fit.noise.common import common_noise, hit_groups

HERTZ = np.array([31.0, 68.0, 127.0, 171.0])
ZETA = np.array([0.006, 0.004, 0.003, 0.005])
PLAN = HammerPlan(
    rate=512.0, samples=2048, hits=4, peak=80.0, width=4e-3, jitter=1e-4, anti_alias="sharp", decay=0.5,
    force_noise=0.15, response_noise=1e-3,
)  # fmt: skip


def structure(seed: int, *, responses: int, points: int, stretch: float = 1.0) -> ModalSystem:
    rng = np.random.default_rng(seed)
    shapes = rng.standard_normal((max(responses, points), len(HERTZ)))
    shapes[:2] = np.sign(shapes[:2]) * np.maximum(np.abs(shapes[:2]), 0.4)
    return modal_system(
        frequency=stretch * HERTZ, damping=ZETA, response_shapes=shapes[:responses], point_shapes=shapes[:points],
        responses=[Dof(100 + i, 3) for i in range(responses)], points=[Dof(i + 1, 3) for i in range(points)],
    )  # fmt: skip


def array(seed: int) -> FrfSet:
    """One point hit, 25 responses in each hit: the noise of the force is the same in all of them."""
    test = hammer_test(structure(seed, responses=25, points=1), PLAN, rng=np.random.default_rng(seed))
    return estimate_frfs(test, band=(10.0, 190.0))


@pytest.mark.long
def test_noise_of_the_force_makes_no_modes_and_its_sigmas_hold() -> None:
    scores = []
    for seed in range(12):
        model = identify(array(seed))
        assert len(model) == len(HERTZ), (seed, model.table())
        scores.append((model.modal.frequency - HERTZ) / model.modal.frequency_sigma)
    assert 0.7 < np.sqrt(np.mean(np.square(scores))) < 1.3  # 48 values: 1 +- 0.1


def test_common_noise_is_found_where_it_is_and_only_there() -> None:
    rng = np.random.default_rng(3)
    n_frf, n_lines = 12, 800
    model = (rng.standard_normal((n_frf, 1)) + 1j * rng.standard_normal((n_frf, 1))) * np.linspace(
        1.0, 3.0, n_lines
    )

    def white(shape: tuple[int, ...]) -> np.ndarray:
        return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)

    frfs = FrfSet(
        1.0 + np.arange(n_lines), model, tuple(Dof(i, 3) for i in range(1, 13)), (Dof(1, 3),) * n_frf
    )
    own = 0.05**2 * np.ones(model.shape)
    assert [list(rows) for rows in hit_groups(frfs)] == [list(range(12))]
    for size in (0.0, 0.1):
        residual = np.sqrt(own) * white(model.shape) + size * model * white((1, n_lines))
        noise = common_noise(frfs, model, residual, own + size**2 * np.abs(model) ** 2)
        assert np.median(noise.variance[0]) == pytest.approx(size**2, rel=0.15)
        left = noise.removed(model, residual)
        assert np.mean(np.abs(left) ** 2 / own) == pytest.approx(1.0, rel=0.15)


def roving(seed: int, drift: float) -> FrfSet:
    """A roving hammer, one response; every point is hit while the structure is a little softer or stiffer."""
    plan = replace(PLAN, drift=drift, force_noise=0.02)
    test = hammer_test(structure(seed, responses=1, points=24), plan, rng=np.random.default_rng(50 + seed))
    return estimate_frfs(test, band=(10.0, 190.0))


@pytest.mark.long
@pytest.mark.parametrize("drift", [0.0, 5e-4, 2e-3])
def test_drift_between_points_splits_no_mode_and_is_in_the_sigma(drift: float) -> None:
    frequency, damping = [], []
    for seed in range(8):
        model = identify(roving(seed, drift))
        assert len(model) == len(HERTZ), (seed, model.table())
        message = any("differ from FRF to FRF" in w for w in model.warnings)
        assert message or drift == 0.0
        frequency.append((model.modal.frequency - HERTZ) / model.modal.frequency_sigma)
        damping.append(model.modal.damping / ZETA - 1.0)
    assert np.sqrt(np.mean(np.square(frequency))) < 1.6  # all modes of a test err together: 8 values
    assert np.abs(damping).max() < 0.03  # 2e-3 is half a half-power width: uncorrected, 20 % and more
