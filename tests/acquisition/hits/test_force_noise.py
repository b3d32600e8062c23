"""Offsets, drifts and noise of the force record beside the pulse change neither verdicts nor modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from acquisition import (
    Dof,
    HammerPlan,
    HammerTest,
    decide,
    estimate_frfs,
    hammer_test,
    judge_hits,
    modal_system,
    pulses_alone,
)
from acquisition.hits.checks import second_hits, without_drift
from identification import identify

BEAM = modal_system(
    frequency=np.array([24.0, 61.0]),
    damping=np.array([0.01, 0.006]),
    response_shapes=np.array([[0.8, -0.6]]),
    point_shapes=np.array([[0.8, -0.6], [0.5, 0.7]]),
    responses=(Dof(1, 3),),
    points=(Dof(1, 3), Dof(2, 3)),
)
PLAN = HammerPlan(
    rate=512.0,
    samples=1024,
    hits=3,
    peak=80.0,
    width=8e-3,
    pre_trigger=0.1,
    force_noise=0.05,
    response_noise=1e-3,
)


def shaken(test: HammerTest, force, motion) -> HammerTest:
    """Return a test with what is given for the whole record, (n_samples,), added to every record."""
    points = tuple(replace(p, force=p.force + force, motion=p.motion + motion) for p in test.points)
    return replace(test, points=points)


def frfs(test: HammerTest):
    """Return the FRFs that the command line makes of a test whose hits are all sound, (2, n_lines) [1/kg]."""
    verdicts = decide(judge_hits(test))
    assert all(v.used for v in verdicts), [v.reasons for v in verdicts if not v.used]
    return estimate_frfs(pulses_alone(test)[0], verdicts=verdicts, band=(10.0, 100.0)).values


@pytest.mark.long
@pytest.mark.parametrize("decay", [0.0, 4.0])
@settings(max_examples=20)
@given(
    offset=st.floats(-200.0, 200.0),
    trend=st.floats(-50.0, 50.0),
    windowed=st.floats(-50.0, 50.0),
    constant=st.floats(-20.0, 20.0),
)
@example(offset=0.0, trend=50.0, windowed=-45.0, constant=0.0)
def test_offset_and_trend_of_any_record_change_no_frf(decay, offset, trend, windowed, constant):
    """In the force also offsets and trends that were there before the window was applied."""
    test = hammer_test(BEAM, replace(PLAN, decay=decay), rng=np.random.default_rng(5))
    time = np.linspace(0.0, 1.0, test.samples)
    before = (windowed + trend * time) * np.exp(-decay * time * test.duration)
    plain, moved = frfs(test), frfs(shaken(test, offset + trend * time + before, constant))
    assert np.abs(moved - plain).max() < 0.01 * np.abs(plain).max()


def test_an_offset_beside_a_stated_window_is_no_pulse(rng):
    """The window is taken back in the force, and with it the offset would grow to the largest value of the record."""
    test = hammer_test(BEAM, replace(PLAN, decay=8.0), rng=rng)
    plain, moved = judge_hits(test), judge_hits(shaken(test, 20.0, 0.0))
    assert [v.used for v in moved] == [v.used for v in plain]
    for one, other in zip(plain, moved, strict=True):
        assert other.peak == pytest.approx(one.peak, rel=1e-3) and other.width == pytest.approx(
            one.width, rel=1e-2
        )
        assert "force has an offset of 20 N" in other.reasons


@pytest.mark.parametrize("decay", [8.0, 16.0, 24.0])
def test_hits_late_in_a_stated_window_have_their_usual_level(rng, decay):
    """The level of a hit and the usual one at its point are both those from before the window."""
    plain = judge_hits(hammer_test(BEAM, replace(PLAN, level_scatter=0.0), rng=rng))
    windowed = judge_hits(hammer_test(BEAM, replace(PLAN, level_scatter=0.0, decay=decay), rng=rng))
    assert all(v.used for v in plain)
    assert all(v.used for v in windowed), [v.reasons for v in windowed if not v.used]


def test_a_weak_hit_is_found_beside_a_stated_window(rng):
    test = hammer_test(BEAM, replace(PLAN, level_scatter=0.0, decay=16.0), rng=rng)
    first, *others = test.points
    soft = replace(
        first, force=first.force * [[1], [0.1], [1]], motion=first.motion * [[[1]], [[0.1]], [[1]]]
    )
    refused = [v for v in judge_hits(replace(test, points=(soft, *others))) if not v.used]
    assert [(str(v.point), v.hit, v.kind) for v in refused] == [("1+Z", 2, "too weak")]


@pytest.mark.parametrize("top", [0, 1, 2, 1021, 1022, 1023])
def test_a_pulse_at_an_end_of_the_record_has_no_second_hit_there(top):
    place = np.arange(1024.0)
    wave = np.maximum(0.0, 1 - ((place - top) / 12) ** 2)
    assert second_hits(wave) == []


def test_a_drift_is_taken_off_and_noise_is_none(rng):
    time = np.arange(2000.0)
    pulse = 50.0 * np.sin(np.pi * np.clip((time - 300) / 9, 0, 1)) ** 2
    noise = 0.1 * rng.standard_normal((200, 2000))
    still = pulse + noise
    middle = np.median(still, axis=-1, keepdims=True)
    assert sum(np.array_equal(a, b) for a, b in zip(without_drift(still), still - middle, strict=True)) >= 199
    left = without_drift(still[:5] + 3.0 + 0.02 * time) - still[:5]
    assert np.abs(left).max() < 0.02


def long_test(rng, *, force_noise, seconds=160.0):
    """A mast hit once, recorded ten times as long as it rings, as with a trigger that nobody stops."""
    mast = modal_system(
        frequency=np.array([2.2, 6.9]),
        damping=np.array([0.004, 0.002]),
        response_shapes=np.array([[0.5, 0.4], [0.3, -0.5]]),
        point_shapes=np.array([[0.5, 0.4]]),
        responses=(Dof(1, 1), Dof(2, 1)),
        points=(Dof(1, 1),),
    )
    plan = HammerPlan(
        rate=32.0, samples=int(32 * seconds), hits=1, peak=3.0, width=0.15, pre_trigger=0.4,
        force_noise=force_noise, response_noise=0.002, level_scatter=0.0,
    )  # fmt: skip
    return hammer_test(mast, plan, rng=rng)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_damping_from_records_far_longer_than_the_ringing(seed):
    raw = long_test(np.random.default_rng(seed), force_noise=0.03)
    test, notes = pulses_alone(raw)
    (note,) = notes
    assert "noise of the force, summed over records of 160 s" in note and "set to zero outside" in note
    found = identify(estimate_frfs(test), band=(0.5, 12.0)).modal
    np.testing.assert_allclose(found.frequency, [2.2, 6.9], rtol=2e-4)
    assert np.all(np.abs(found.damping - [0.004, 0.002]) < 4 * found.damping_sigma)
    np.testing.assert_allclose(found.damping, [0.004, 0.002], rtol=0.1)


def test_without_noise_worth_a_word_the_records_stay_as_they_are(rng):
    raw = long_test(rng, force_noise=1e-5)
    test, notes = pulses_alone(raw)
    assert notes == () and test.points[0].force is raw.points[0].force


def test_a_second_push_and_a_negative_rebound_stay_in_the_force(rng):
    raw = long_test(rng, force_noise=0.03)
    (point,) = raw.points
    place = int(point.force[0].argmax())
    force = point.force.copy()
    force[0] += (
        0.3
        * np.roll(force[0], 40)
        * (np.arange(raw.samples) > place + 30)
        * (np.arange(raw.samples) < place + 50)
    )
    force[0] -= 0.2 * np.roll(force[0], 8) * (np.abs(np.arange(raw.samples) - place - 8) < 4)
    test, _ = pulses_alone(replace(raw, points=(replace(point, force=force),)))
    kept = test.points[0].force[0]
    assert kept[place + 40] == pytest.approx(force[0, place + 40], abs=0.05)
    assert kept[place + 8] == pytest.approx(force[0, place + 8], abs=0.05) and kept[place + 8] < 0
    assert np.all(kept[place + 80 :] == 0)


def test_a_soft_hit_that_is_the_only_one_at_its_point_is_sound(rng):
    test = hammer_test(BEAM, replace(PLAN, force_noise=0.08), rng=rng)
    hard, soft = test.points
    alone = replace(soft, force=0.1 * soft.force[:1], motion=0.1 * soft.motion[:1])
    verdicts = judge_hits(replace(test, points=(hard, alone)))
    assert all(v.used for v in verdicts)
    among = replace(hard, force=hard.force * [[1], [0.1], [1]], motion=hard.motion * [[[1]], [[0.1]], [[1]]])
    refused = [v for v in judge_hits(replace(test, points=(among, alone))) if not v.used]
    assert [(str(v.point), v.hit, v.kind) for v in refused] == [("1+Z", 2, "too weak")]


def test_a_record_without_a_pulse_changes_no_other(rng):
    """A trigger by chance stores noise alone; it is refused, and what is done to the other forces stays the same."""
    test = hammer_test(BEAM, replace(PLAN, force_noise=0.02), rng=rng)
    first, *others = test.points
    force = np.concatenate([first.force, 0.02 * rng.standard_normal((1, test.samples))])
    chance = replace(first, force=force, motion=np.concatenate([first.motion, first.motion[:1]]))
    alone, notes = pulses_alone(replace(test, points=(chance, *others)))
    kept, expected = pulses_alone(test)
    assert notes == expected
    np.testing.assert_array_equal(alone.points[0].force[:-1], kept.points[0].force)
