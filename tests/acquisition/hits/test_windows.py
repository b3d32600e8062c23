"""Windows take nothing from the amplitude, whatever they were applied to and wherever they begin."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from acquisition import (
    Dof,
    HammerPlan,
    InputError,
    Windows,
    apply_windows,
    estimate_frfs,
    hammer_test,
    modal_system,
)
from acquisition.hits.windows import force_noise_decay, state_window

DECAY = 9.0
SDOF = modal_system(
    frequency=np.array([80.0]),
    damping=np.array([0.01]),
    response_shapes=np.array([[0.8]]),
    point_shapes=np.array([[0.8]]),
    responses=(Dof(1, 3),),
    points=(Dof(1, 3),),
)
PLAN = HammerPlan(rate=2048.0, samples=4096, hits=4, width=2e-3, pre_trigger=0.05, jitter=0.01, adc_bits=None)


def windowed(rng, *, on, origin, force_noise=0.0):
    """Multiply clean records by exp(-d (t - origin)), as an analyser does before it stores them."""
    test = hammer_test(SDOF, replace(PLAN, force_noise=force_noise), rng=rng)
    window = np.exp(-DECAY * (np.arange(test.samples) / test.rate - origin))
    (point,) = test.points
    force = point.force * window if on == "both" else point.force
    return replace(test, points=(replace(point, force=force, motion=point.motion * window),))


def miss(test):
    """Compare with H(i omega + d) of the single degree of freedom, phi^2 s^2 / (s^2 + 2 zeta w s + w^2)."""
    frfs = estimate_frfs(test).band(20.0, 300.0)
    s = 2j * np.pi * frfs.frequency + DECAY
    omega = 2 * np.pi * 80.0
    exact = 0.64 * s**2 / (s**2 + 2 * 0.01 * omega * s + omega**2)
    return float(np.abs(frfs.values[0] - exact).max() / np.abs(exact).max())


@pytest.mark.parametrize("origin", [0.0, 0.05, 0.3])
def test_a_window_on_both_leaves_the_amplitude_wherever_it_begins(rng, origin):
    stated, _ = state_window(windowed(rng, on="both", origin=origin), decay=DECAY, on="both")
    assert stated.decay == DECAY and miss(stated) < 2e-4


@pytest.mark.parametrize("origin", [0.0, 0.05])
def test_a_window_on_the_responses_alone_is_set_right_hit_by_hit(rng, origin):
    raw = windowed(rng, on="responses", origin=origin)
    stated, _ = state_window(raw, decay=DECAY, on="responses", origin=origin)
    assert miss(stated) < 2e-4
    untouched = miss(replace(raw, decay=DECAY))
    # left as it is, the FRF is H(s + d) exp(-d (t_hit - t0)): with the hit at 0.05 s, a third is lost from the start on
    expected = abs(1 - np.exp(-DECAY * (0.051 - origin)))
    assert untouched > 50 * miss(stated) and untouched == pytest.approx(expected, abs=0.08)


def test_the_programs_own_windows_leave_the_amplitude(rng):
    test = hammer_test(SDOF, PLAN, rng=rng)
    assert miss(apply_windows(test, Windows(decay=DECAY))) < 2e-4
    assert miss(apply_windows(test, Windows(decay=DECAY, force_length=0.02))) < 2e-4


@pytest.mark.parametrize("on", ["both", "responses"])
def test_the_noise_of_the_force_tells_what_was_windowed(rng, on):
    raw = windowed(rng, on=on, origin=0.0, force_noise=0.1)
    assert force_noise_decay(raw) == pytest.approx(DECAY if on == "both" else 0.0, abs=0.5)
    stated, messages = state_window(raw, decay=DECAY)
    assert bool(messages) == (on == "responses")
    assert miss(stated) < 0.02  # with noise on the force; left as it is, the responses alone miss by a third
    assert len(messages) == 0 or "responses alone" in messages[0]


def without_noise(test):
    """Return a test whose force is zero beside its pulses."""
    (point,) = test.points
    return replace(
        test, points=(replace(point, force=np.where(np.abs(point.force) > 1e-3, point.force, 0.0)),)
    )


def test_where_the_force_has_no_noise_the_assumption_is_stated_with_what_it_changes(rng):
    silent = without_noise(windowed(rng, on="both", origin=0.0))
    stated, (message,) = state_window(silent, decay=DECAY)
    assert force_noise_decay(silent) is None
    assert stated.points[0].force is silent.points[0].force
    gain = np.exp(DECAY * silent.points[0].force.argmax(axis=1) / silent.rate).mean()
    assert "assumed to be on both" in message and "--window-on responses" in message
    times = [float(x) for x in re.findall(r"([0-9.]+) times", message)]
    assert times == pytest.approx([gain, np.sqrt(gain)], rel=0.01)
    other, _ = state_window(silent, decay=DECAY, on="responses")
    ratio = np.abs(estimate_frfs(other).values / estimate_frfs(stated).values)[0, 100:400]
    assert ratio == pytest.approx(gain, rel=0.1)


def test_hits_at_the_start_of_the_records_leave_nothing_to_state(rng):
    plan = replace(PLAN, pre_trigger=0.0, jitter=0.0, width=1e-3)
    test = without_noise(hammer_test(SDOF, plan, rng=rng))
    assert state_window(test, decay=0.5)[1] == ()


@pytest.mark.parametrize("behind", ["zero", "fast"])
@pytest.mark.parametrize("force_noise", [0.002, 0.1])
def test_a_force_window_leaves_the_exponential_one_to_the_responses(rng, behind, force_noise):
    """The usual setting of an analyser: the force is cut off, or falls fast, behind the pulse."""
    raw = windowed(rng, on="responses", origin=0.0, force_noise=force_noise)
    time = np.arange(raw.samples) / raw.rate
    after = np.maximum(time - 0.12, 0.0)
    weight = time < 0.12 if behind == "zero" else np.exp(-60.0 * after)
    (point,) = raw.points
    stated, (message,) = state_window(
        replace(raw, points=(replace(point, force=point.force * weight),)), decay=DECAY
    )
    assert "on the responses alone" in message and "--window-on both" in message
    assert miss(stated) < 0.02


@pytest.mark.parametrize("on", ["both", "responses"])
def test_noise_before_the_pulse_shows_what_was_windowed_where_none_is_left_behind_it(rng, on):
    plan = replace(PLAN, pre_trigger=0.3, jitter=0.0, force_noise=0.1, hits=8)
    test = hammer_test(SDOF, plan, rng=rng)
    time = np.arange(test.samples) / test.rate
    (point,) = test.points
    window = np.exp(-DECAY * time)
    force = point.force * (window if on == "both" else 1.0) * (time < 0.33)
    stored = replace(test, points=(replace(point, force=force, motion=point.motion * window),))
    stated, messages = state_window(stored, decay=DECAY)
    assert len(messages) == (on == "responses")
    known, _ = state_window(stored, decay=DECAY, on=on)
    np.testing.assert_array_equal(stated.points[0].force, known.points[0].force)


def test_coarse_steps_are_not_taken_for_steady_noise(rng):
    """A force that was windowed and then rounded has steps at its end where its noise was."""
    raw = windowed(rng, on="both", origin=0.0, force_noise=0.05)
    step = 0.1
    force = np.round(raw.points[0].force / step) * step
    stated, _ = state_window(replace(raw, points=(replace(raw.points[0], force=force),)), decay=DECAY)
    np.testing.assert_array_equal(stated.points[0].force, force)


def test_what_cannot_be_a_window_is_refused(rng):
    test = hammer_test(SDOF, replace(PLAN, hits=1), rng=rng)
    assert state_window(test, decay=0.0) == (test, ())
    with pytest.raises(InputError, match="give a rate of 0 or above"):
        state_window(test, decay=-1.0)
    with pytest.raises(InputError, match="stated already"):
        state_window(replace(test, decay=2.0), decay=1.0)


def test_a_force_window_does_not_turn_an_offset_into_a_step(rng):
    test = hammer_test(SDOF, replace(PLAN, decay=0.0), rng=rng)
    (point,) = test.points
    shifted = replace(test, points=(replace(point, force=point.force + 5.0),))
    one = apply_windows(test, Windows(force_length=0.02)).points[0].force
    two = apply_windows(shifted, Windows(force_length=0.02)).points[0].force
    np.testing.assert_allclose(one, two, atol=0.05)
