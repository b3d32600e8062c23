"""Long records are cut into hits; what cannot be cut out is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from acquisition import Dof, HammerPlan, HammerTest, Hits, InputError, hammer_test, judge_hits, modal_system
from acquisition.hits.splitting import holds_several_hits, propose_trigger, split_hits

RATE = 4096.0
SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0, 300.0]),
    damping=np.array([0.02, 0.015, 0.01]),
    response_shapes=np.array([[1.0, 0.7, 0.3], [0.4, -0.8, 0.5]]),
    point_shapes=np.array([[1.0, 0.7, 0.3]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3),),
)


def long_test(rng, times, *, length=14.0, levels=None, noise=0.05, offset=0.0):
    """Superpose single hits of a synthetic test at the given times; the structure is linear."""
    plan = HammerPlan(rate=RATE, samples=8192, hits=len(times), level_scatter=0.2)
    single = hammer_test(SYSTEM, plan, rng=rng).points[0]
    n = int(length * RATE)
    force, motion = np.zeros(n + 8192), np.zeros((2, n + 8192))
    for k, at in enumerate(times):
        start = int((at - plan.pre_trigger) * RATE)
        gain = 1.0 if levels is None else levels[k]
        force[start : start + 8192] += gain * single.force[k]
        motion[:, start : start + 8192] += gain * single.motion[k]
    force = force[:n] + offset + noise * rng.standard_normal(n)
    return HammerTest(RATE, (Hits(Dof(1, 3), single.responses, force[None], motion[None, :, :n]),)), single


TIMES = (1.0, 3.2, 5.1, 7.6, 9.9, 12.0)


@pytest.mark.parametrize("offset", [0.0, -8.0])
def test_every_hit_gets_a_record_with_its_own_samples(rng, offset):
    test, _ = long_test(rng, TIMES, offset=offset)
    assert holds_several_hits(test)
    cut, messages = split_hits(test)
    (point,) = cut.points
    assert point.count == 6 and cut.samples < 1.9 * RATE and cut.samples > 1.8 * RATE
    assert len(messages) == 1 and "6 hits" in messages[0]
    peaks = point.force.argmax(axis=1)
    assert np.ptp(peaks) <= 2  # triggered, so all pulses stand at one place
    for k, at in enumerate(TIMES):
        start = int(test.points[0].force[0][int((at - 0.1) * RATE) : int((at + 0.1) * RATE)].argmax())
        start += int((at - 0.1) * RATE) - int(peaks[k])
        np.testing.assert_array_equal(point.force[k], test.points[0].force[0, start : start + cut.samples])
        np.testing.assert_array_equal(
            point.motion[k], test.points[0].motion[0, :, start : start + cut.samples]
        )
    assert not holds_several_hits(cut)
    assert all(v.used for v in judge_hits(cut))


def test_a_bounce_stays_one_hit_and_is_found_as_double(rng):
    times = (*TIMES, 5.13)
    test, _ = long_test(rng, times, levels=[1, 1, 1, 1, 1, 1, 0.4])
    cut, _ = split_hits(test)
    refused = [v for v in judge_hits(cut) if not v.used]
    assert cut.points[0].count == 6
    assert [v.hit for v in refused] == [3] and "double hit" in refused[0].reasons[0]


def test_hits_too_close_to_each_other_or_to_the_end_are_said(rng):
    test, _ = long_test(rng, (1.0, 3.2, 3.7, 6.0, 8.0, 10.0, 13.5))
    cut, messages = split_hits(test)
    stated = "\n".join(messages[1:])
    assert cut.points[0].count == 4 and len(messages) == 4
    assert "3.2 s was left out: the next hit follows after 0.5 s" in stated
    assert "3.7 s was left out: the hit 0.5 s before it still rings" in stated
    assert "13.5 s is too close to the end" in stated


def test_given_trigger_pre_and_duration_are_taken(rng):
    test, _ = long_test(rng, TIMES, levels=[1, 1, 0.05, 1, 1, 1])
    cut, _ = split_hits(test, trigger=30.0, pre=0.125, duration=1.5)
    assert cut.points[0].count == 5 and cut.samples == 6144
    above = (cut.points[0].force >= 30).argmax(axis=1)
    assert above.tolist() == [512] * 5
    assert split_hits(test, trigger=1.0, duration=1.5)[0].points[0].count == 6


def test_a_proposed_trigger_lies_between_noise_and_peaks(rng):
    for noise in (0.01, 0.5):
        test, single = long_test(rng, TIMES, noise=noise)
        assert 8 * noise < propose_trigger(test) < 0.3 * single.force.max(axis=1).min()


def test_ordinary_records_are_not_long_even_with_a_late_double(rng):
    plan = HammerPlan(rate=RATE, samples=8192, hits=5, bad={(0, 2): "double"})
    test = hammer_test(SYSTEM, plan, rng=rng)
    assert not holds_several_hits(test)
    force = np.array(test.points[0].force)
    force[1] += 0.5 * np.roll(force[1], int(0.8 * RATE))
    assert not holds_several_hits(replace(test, points=(replace(test.points[0], force=force),)))


def test_what_cannot_be_split_says_why(rng):
    test, _ = long_test(rng, TIMES)
    with pytest.raises(InputError, match="reaches the trigger of 10000 N"):
        split_hits(test, trigger=1e4)
    with pytest.raises(InputError, match=r"followed by 5 s without.*one hit at a time"):
        split_hits(test, duration=5.0)
    with pytest.raises(InputError, match=r"records of 50 s do not fit into the 14 s recorded"):
        split_hits(test, duration=50.0)
    with pytest.raises(InputError, match=r"no room for 2 s before the trigger"):
        split_hits(test, duration=1.0, pre=2.0)
    with pytest.raises(
        InputError,
        match=r"several hits, and an exponential window of 3 1/s.*without the window.*from --decay",
    ):
        split_hits(replace(test, decay=3.0))


COARSE, OVER = 1536.0, 16


def through(test, kind, order, corner):
    """Return a finely sampled test through an anti-alias filter (corner relative to the rate), taken coarsely."""
    design = {"ellip": (0.1, 80), "cheby1": (0.5,)}[kind]
    filters = {"ellip": scipy.signal.ellip, "cheby1": scipy.signal.cheby1}
    sos = filters[kind](order, *design, corner * COARSE, fs=test.rate, output="sos")
    return replace(
        test,
        rate=COARSE,
        points=tuple(
            replace(
                p,
                force=scipy.signal.sosfilt(sos, p.force)[:, ::OVER],
                motion=scipy.signal.sosfilt(sos, p.motion)[..., ::OVER],
            )
            for p in test.points
        ),
    )


@pytest.mark.parametrize("samples", [128, 2048])
@pytest.mark.parametrize(("kind", "order"), [("ellip", 8), ("ellip", 12), ("cheby1", 12)])
def test_the_ringing_of_a_sharp_filter_is_not_several_hits(rng, kind, order, samples):
    """Pulses shorter than a sample leave side lobes of 30 to 50 %, some samples after the peak."""
    highest = 0.0
    for width in (1e-4, 5e-4, 1e-3):
        plan = HammerPlan(
            rate=OVER * COARSE, samples=OVER * samples, hits=2, width=width, pre_trigger=0.02, adc_bits=None
        )
        fine = hammer_test(SYSTEM, plan, rng=rng)
        for corner in (0.15, 0.25, 1 / 2.56, 0.45):
            test = through(fine, kind, order, corner)
            for wave in test.points[0].force:
                top = int(wave.argmax())
                tops, _ = scipy.signal.find_peaks(wave[top + 1 :])
                highest = max(highest, float(wave[top + 1 :][tops].max() / wave[top]))
            assert not holds_several_hits(test)
            assert samples < 2048 or all(v.used for v in judge_hits(test))
    assert highest > 0.3  # so the lobes would count as hits of comparable force


@pytest.mark.parametrize("kind", ["ellip", "cheby1"])
def test_hits_through_a_sharp_filter_are_split_and_a_double_hit_is_found(rng, kind):
    plan = HammerPlan(
        rate=OVER * COARSE, samples=OVER * 1536, hits=4, width=5e-4, pre_trigger=0.1, adc_bits=None
    )
    single = hammer_test(SYSTEM, plan, rng=rng)
    (point,) = single.points
    once = replace(single, points=(replace(point, force=point.force[:1], motion=point.motion[:1]),))
    row = replace(
        once,
        points=(
            replace(
                point,
                force=np.concatenate(list(point.force))[None],
                motion=np.concatenate(list(point.motion), axis=-1)[None],
            ),
        ),
    )
    test = through(row, kind, 8, 1 / 2.56)
    assert (
        holds_several_hits(test) and split_hits(test)[0].points[0].count == 3
    )  # the last ends with the record
    late = int(0.05 * once.rate)
    double = replace(
        once,
        points=tuple(
            replace(
                p,
                force=p.force + 0.4 * np.roll(p.force, late, axis=-1),
                motion=p.motion + 0.4 * np.roll(p.motion, late, axis=-1),
            )
            for p in once.points
        ),
    )
    test = through(double, kind, 8, 1 / 2.56)
    (verdict,) = judge_hits(test)
    assert not holds_several_hits(test) and "double hit: 4" in verdict.reasons[0]


def test_records_that_are_all_double_hits_are_not_long(rng):
    every = {(0, hit): "double" for hit in range(4)}
    test = hammer_test(SYSTEM, HammerPlan(rate=RATE, samples=8192, hits=4, bad=every), rng=rng)
    point = test.points[0]
    force = point.force + 0.4 * np.roll(point.force, 200, axis=-1)
    assert not holds_several_hits(replace(test, points=(replace(point, force=force),)))
