"""A force that a window cuts off while the filter of its converter rings has nearly the spectrum of the whole one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, HammerPlan, HammerTest, hammer_test, modal_system, pulses_alone
from acquisition.hits.force_tail import with_tails

BEAM = modal_system(
    frequency=np.array([60.0, 210.0]),
    damping=np.array([0.01, 0.006]),
    response_shapes=np.array([[0.8, -0.6]]),
    point_shapes=np.array([[0.8, -0.6], [0.5, 0.7], [0.3, 0.9]]),
    responses=(Dof(1, 3),),
    points=(Dof(1, 3), Dof(2, 3), Dof(3, 3)),
)
PLAN = HammerPlan(
    rate=1024.0, samples=2048, hits=5, peak=80.0, width=2.5e-3, pre_trigger=0.03, force_noise=8e-3, anti_alias="sharp"
)  # fmt: skip
AFTER = 0.02


def whole(plan: HammerPlan = PLAN, seed: int = 1) -> HammerTest:
    return hammer_test(BEAM, plan, rng=np.random.default_rng(seed))


def cut(test: HammerTest, plan: HammerPlan = PLAN) -> HammerTest:
    """Return it with a force window that ends a little behind the pulse."""
    open_for = np.arange(test.samples) < round((plan.pre_trigger + plan.width + AFTER) * test.rate)
    return replace(test, points=tuple(replace(p, force=p.force * open_for) for p in test.points))


def error(test: HammerTest, of: HammerTest, top: float = 400.0) -> float:
    """Return how far the spectra of the forces are off up to a frequency, r.m.s. [-]."""
    lines = np.fft.rfftfreq(of.samples, 1 / of.rate) < top
    true, found = (
        np.fft.rfft(np.concatenate([p.force for p in t.points]), axis=-1)[:, lines] for t in (of, test)
    )
    return float(np.sqrt(np.mean(np.abs(found / true - 1) ** 2)))


@pytest.mark.parametrize("seed", range(3))
def test_what_is_cut_off_is_continued(seed: int) -> None:
    quiet = replace(PLAN, force_noise=1e-6)
    true = whole(quiet, seed)
    shut = cut(true)
    found, said = with_tails(shut)
    assert error(shut, true) > 3e-3
    assert error(found, true) < 0.2 * error(shut, true)
    assert len(said) == 1 and "ends the force while" in said[0]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_noise_leaves_most_of_the_gain(seed: int) -> None:
    true = whole(PLAN, seed)
    ringing = whole(replace(PLAN, force_noise=1e-6), seed)
    shut = cut(true)
    # the noise that is cut off is no loss: the force to compare with has the noise of the open window alone
    pairs = zip(shut.points, ringing.points, strict=True)
    points = tuple(replace(p, force=np.where(p.force == 0, q.force, p.force)) for p, q in pairs)
    best = replace(shut, points=points)
    assert error(with_tails(shut)[0], best) < 0.4 * error(shut, best)


@pytest.mark.long
def test_units_change_nothing() -> None:
    shut = cut(whole())
    other = replace(shut, points=tuple(replace(p, force=1e-3 * p.force) for p in shut.points))
    for one, two in zip(with_tails(shut)[0].points, with_tails(other)[0].points, strict=True):
        np.testing.assert_allclose(1e-3 * one.force, two.force, rtol=1e-4, atol=1e-6)


def test_a_force_that_nothing_cuts_stays_as_it_is() -> None:
    test = whole()
    assert with_tails(test) == (test, ())


def test_a_cut_behind_all_ringing_changes_next_to_nothing_without_a_warning() -> None:
    smooth = replace(PLAN, anti_alias="smooth")
    shut = cut(whole(smooth))
    found, said = with_tails(shut)
    assert said == ()
    assert error(found, shut) < 1e-3


@pytest.mark.long
def test_forces_are_continued_before_they_are_averaged() -> None:
    found, said = pulses_alone(cut(whole()))
    assert any("ends the force while" in one for one in said)
    assert all(np.any(p.force[:, -1] != 0) or np.any(p.force[:, 100] != 0) for p in found.points)


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("width", [5, 60, 150, 400])
def test_a_pulse_that_is_zero_behind_its_end_is_whole(width: int, power: int) -> None:
    """As simulated hits are: nothing rings, and what goes down to zero goes on nowhere."""
    hit = whole()
    force = np.zeros(hit.samples)
    force[100 : 101 + width] = 50.0 * np.sin(np.pi * np.arange(width + 1) / width) ** power
    force[np.abs(force) < 1e-12] = 0.0
    test = replace(
        hit, points=tuple(replace(p, force=np.outer([1.0, 1.2, 0.8, 1.1, 0.9], force)) for p in hit.points)
    )
    assert with_tails(test) == (test, ())
