"""A free beam on soft cords: two rigid-body modes near 2 Hz with few lines, noise, and nodes."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import Dof, decide, estimate_frfs, hammer_test, judge_hits, pulses_alone, state_window
from acquisition.synthetic import HammerPlan, modal_system
from identification import identify

ALPHA = np.array([4.7300407, 7.8532046, 10.9956078, 14.1371655])
DAMPING = np.array([0.02, 0.026, 0.004, 0.003, 0.003, 0.003])
RATE = 1024.0


def shapes(x):
    """Return the shapes of a free beam of unit mean square, the rigid ones first, (n_points, 6)."""
    a = ALPHA[None, :]
    s = (np.cosh(a) - np.cos(a)) / (np.sinh(a) - np.sin(a))
    ax = a * x[:, None]
    bending = np.cosh(ax) + np.cos(ax) - s * (np.sinh(ax) + np.sin(ax))
    return np.column_stack([np.ones_like(x), np.sqrt(3.0) * (2 * x - 1), bending])


def free_beam(rigid, duration, seed):
    """Return FRFs of eleven points hit, one accelerometer at the end, noise of 1 % of its r.m.s."""
    hertz = np.array([*rigid, 60.0, 165.0, 324.0, 535.0])
    at = shapes(np.linspace(0.0, 1.0, 11)) / np.sqrt(2.0)
    system = modal_system(
        frequency=hertz, damping=DAMPING, response_shapes=at[[10]], point_shapes=at,
        responses=[Dof(11, 3)], points=[Dof(k + 1, 3) for k in range(11)],
    )  # fmt: skip
    slowest = float((DAMPING * 2 * np.pi * hertz).min())
    plan = HammerPlan(
        rate=RATE, samples=int(RATE * duration), hits=4, peak=80.0, width=1.5e-3, pre_trigger=0.01, jitter=1e-4,
        decay=max(0.0, 4.6 / duration - slowest), force_noise=0.024, response_noise=1e-2, adc_bits=24,
        position_sigma=0.0, drift=5e-5, anti_alias="sharp",
    )  # fmt: skip
    test, _ = state_window(hammer_test(system, plan, rng=np.random.default_rng(seed)), decay=0.0)
    return estimate_frfs(pulses_alone(test)[0], verdicts=decide(judge_hits(test)))


@pytest.mark.long
def test_two_rigid_body_modes_in_few_lines_are_no_drift_of_one():
    model = identify(free_beam((1.85, 2.19), 2.0, seed=0), band=(1.0, 450.0))
    rigid = model.modal.frequency < 10
    assert np.allclose(model.modal.frequency[rigid], [1.85, 2.19], atol=0.1)
    assert not any("differ from FRF to FRF" in w for w in model.warnings)


@pytest.mark.long
def test_a_node_tells_nothing_of_a_drift():
    """The middle is a node of the second bending mode: there any shift fits, and would be a scatter of that mode."""
    model = identify(free_beam((1.85, 2.19), 4.0, seed=0), band=(1.0, 450.0))
    mode = int(np.abs(model.modal.frequency - 165.0).argmin())
    assert model.modal.frequency_sigma[mode] < 0.02
    assert not any("differ from FRF to FRF" in w for w in model.warnings)
