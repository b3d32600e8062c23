"""A window that nobody stated moves poles by its decay and nothing else: no mode is drawn aside by it."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet, estimate_frfs
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test, modal_system
from identification import identify

HERTZ, ZETA = np.array([28.34, 177.18, 494.08, 963.5]), np.array([0.0101, 0.0011, 0.0009, 0.0016])
PLAN = HammerPlan(
    rate=3072.0, samples=3277, hits=4, peak=80.0, width=1 / 1200, pre_trigger=64 / 3072, anti_alias="smooth",
    force_noise=8e-3, response_noise=1e-3,
)  # fmt: skip


def structure() -> ModalSystem:
    shapes = np.random.default_rng(1).standard_normal((7, len(HERTZ)))
    return modal_system(
        frequency=HERTZ, damping=ZETA, response_shapes=shapes[:1], point_shapes=shapes, responses=[Dof(1, 3)],
        points=[Dof(i + 1, 3) for i in range(7)],
    )  # fmt: skip


def exact(system: ModalSystem, decay: float, like: FrfSet) -> FrfSet:
    """FRFs of the structure as a window on both channels leaves them."""
    s = 2j * np.pi * like.frequency + decay
    values = np.zeros_like(like.values)
    for pole, residues in zip(system.poles, system.residues[0].T, strict=True):
        values += s**2 * (residues[:, None] / (s - pole) + residues.conj()[:, None] / (s - pole.conj()))
    return replace(like, values=values, variance=None, coherence=None, averages=None, record=None)


@pytest.mark.long
@pytest.mark.parametrize("decay", [0.0, 2.0, 7.3])
@pytest.mark.parametrize("noise", [True, False])
def test_poles_are_those_of_the_structure_moved_by_the_window(decay: float, noise: bool) -> None:
    system = structure()
    test = hammer_test(system, replace(PLAN, decay=decay), rng=np.random.default_rng(2))
    frfs = estimate_frfs(replace(test, decay=0.0), band=(7.2, 1200.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = identify(frfs if noise else exact(system, decay, frfs), band=(7.2, 1200.0))
    wanted = system.poles - decay
    hertz, zeta = np.abs(wanted) / (2 * np.pi), -wanted.real / np.abs(wanted)
    assert len(model) == len(HERTZ)
    data = model.modal
    if noise:
        assert np.all(np.abs(data.frequency - hertz) < 3.5 * data.frequency_sigma)
        assert np.all(np.abs(data.damping - zeta) < 3.5 * data.damping_sigma)
        assert np.all(data.frequency_sigma < 2e-4 * hertz)
    else:
        assert data.frequency == pytest.approx(hertz, rel=2e-5)
        assert data.damping == pytest.approx(zeta, rel=2e-3)
    # what was recorded are accelerations: their residues p^2 R are divided by the moved pole's square
    turned = np.angle(np.sum(model.constants**2, axis=0)) / 2
    assert turned == pytest.approx(-2 * np.arctan2(decay, 2 * np.pi * hertz), abs=0.02 if noise else 2e-3)
