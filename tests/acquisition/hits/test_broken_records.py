"""Records without a hit in them: refused with the reason, and the other hits used."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import (
    Dof,
    EstimationError,
    HammerPlan,
    HammerTest,
    estimate_frfs,
    hammer_test,
    judge_hits,
    modal_system,
)
from acquisition.hits.checks import dead_from
from acquisition.hits.splitting import holds_several_hits

SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0, 300.0]),
    damping=np.array([0.02, 0.015, 0.01]),
    response_shapes=np.array([[1.0, 0.7, 0.3], [0.4, -0.8, 0.5]]),
    point_shapes=np.array([[1.0, 0.7, 0.3], [0.5, -0.6, 0.9]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3), Dof(2, 3)),
)


def test_of(rng, *, hits=20) -> HammerTest:
    plan = HammerPlan(rate=2048.0, samples=2048, hits=hits, force_noise=0.02, response_noise=1e-3)
    return hammer_test(SYSTEM, plan, rng=rng)


test_of.__test__ = False  # type: ignore[attr-defined]


def changed(test, change):
    points = []
    for number, point in enumerate(test.points):
        force, motion = np.array(point.force), np.array(point.motion)
        change(number, force, motion)
        points.append(replace(point, force=force, motion=motion))
    return replace(test, points=tuple(points))


def one_hit(value):
    def change(point, force, motion):
        if point == 0:
            force[4] = value

    return change


@pytest.mark.parametrize("value", [0.0, 0.01, -5.0])
def test_a_dead_force_is_refused_by_name_and_changes_no_other_verdict(rng, value):
    test = test_of(rng)
    before = judge_hits(test)
    after = judge_hits(changed(test, one_hit(value)))
    refused = [v for v in after if not v.used]
    assert [(str(v.point), v.hit) for v in refused] == [("1+Z", 5)]
    assert refused[0].reasons == (f"no force: the record is constant, {value:.3g} N throughout",)
    for old, new in zip(before, after, strict=True):
        assert new.hit == old.hit and (not new.used or new == old)


def test_when_most_hits_are_dead_the_rest_are_used(rng):
    def change(point, force, motion):
        force[:14] = 0.01

    verdicts = judge_hits(changed(test_of(rng), change))
    assert sum(v.used for v in verdicts) == 12
    noise = np.random.default_rng(1)

    def hiss(point, force, motion):
        force[:14] = 0.02 * noise.standard_normal(force[:14].shape)

    verdicts = judge_hits(changed(test_of(rng), hiss))
    assert sum(v.used for v in verdicts) == 12


def test_values_that_are_not_finite_cost_their_hit_alone(rng):
    def change(point, force, motion):
        motion[point, 1, 7] = np.nan
        force[point + 2, 3] = np.inf

    verdicts = judge_hits(changed(test_of(rng, hits=6), change))
    assert [(str(v.point), v.hit) for v in verdicts if not v.used] == [
        ("1+Z", 1),
        ("1+Z", 3),
        ("2+Z", 2),
        ("2+Z", 4),
    ]
    assert all("not finite" in v.reasons[0] for v in verdicts if not v.used)


@pytest.mark.parametrize("offset", [20.0, -300.0])
def test_an_offset_of_the_force_is_noted_and_harmless(rng, offset):
    test = test_of(rng, hits=5)

    def change(point, force, motion):
        force += offset

    shifted = changed(test, change)
    verdicts = judge_hits(shifted)
    assert all(v.used for v in verdicts)
    assert all(any("offset" in reason for reason in v.reasons) for v in verdicts)
    old, new = estimate_frfs(test, band=(20, 400)), estimate_frfs(shifted, band=(20, 400))
    np.testing.assert_allclose(new.values, old.values, rtol=1e-6, atol=1e-9 * np.abs(old.values).max())


@pytest.mark.parametrize("samples", [1, 2, 8, 31])
def test_records_of_a_few_samples_are_too_short(rng, samples):
    test = test_of(rng, hits=3)
    short = replace(
        test,
        points=tuple(
            replace(p, force=p.force[:, :samples], motion=p.motion[..., :samples]) for p in test.points
        ),
    )
    verdicts = judge_hits(short)
    assert not holds_several_hits(short) and not any(v.used for v in verdicts)
    with pytest.raises(EstimationError, match=r"no usable hit.*most frequent reason, 6 of 6 hits: too short"):
        estimate_frfs(short, verdicts=verdicts)


def test_a_short_record_that_lives_to_its_end_is_not_cut_off():
    ringing = np.cos(np.arange(48.0)) * np.exp(-0.01 * np.arange(48.0))
    assert dead_from(ringing[None])[0] == 1.0
