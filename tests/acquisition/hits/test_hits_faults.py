"""Verdicts over random measuring chains: hardly an alarm on clean hits, hardly a fault missed.

The full table, with 400 cases a kind, is printed by benchmarks/bench_hits.py.
"""

from __future__ import annotations

from dataclasses import replace

import hit_cases as cases
import numpy as np
import pytest

from acquisition import Dof, HammerTest, Hits, judge_hits, unstated_window
from acquisition.hits.checks import at_common_limit, dead_from, dropouts, flat_waves, second_hits, upright
from acquisition.hits.checks.ringing import ringing_period, without_ringing

NUMBER = 40


def refused(rng, word, make, number=NUMBER):
    """Return in how many of the cases the hit is refused with the word among its reasons."""
    verdicts = [judge_hits(make(cases.setting(rng)))[0] for _ in range(number)]
    return sum(not v.used and any(word in r for r in v.reasons) for v in verdicts)


@pytest.mark.parametrize("filtered", [None, "butter", "cheby1", "ellip", "bessel", "fir"])
def test_clean_hits_of_any_chain_raise_no_alarm(rng, filtered):
    """2-50 kHz, 1-6 ms, noise of 0.1-1 %, offset up to 10 %, either polarity."""
    assert refused(rng, "", lambda s: cases.one_force(rng, s, filtered=filtered)) <= 1


@pytest.mark.parametrize("second", [(1.3, 10), (20, 400), (-6, -1.3)])
@pytest.mark.parametrize("filtered", [None, "any"])
def test_second_hits_of_a_tenth_are_found_soon_late_and_before(rng, second, filtered):
    if filtered and second[0] > 0:
        second = (max(second[0], 2.0), second[1])
    found = refused(
        rng, "double", lambda s: cases.one_force(rng, s, second=second, height=0.1, filtered=filtered)
    )
    assert found >= NUMBER - (1 if filtered is None else 3)


def test_second_hits_on_the_tail_of_the_first_are_found(rng):
    """Touching the first: from 0.9 to 1.3 widths after it, without a clear valley between them."""
    assert refused(rng, "double", lambda s: cases.one_force(rng, s, second=(0.9, 1.3))) >= 0.8 * NUMBER


def test_clipped_forces_are_found_even_when_a_filter_has_rounded_them(rng):
    for faults in ({"clip": 0.85}, {"clip": 0.8, "filtered": "any"}):
        found = 0
        for _ in range(NUMBER):
            s = cases.setting(rng, rate=(12e3, 5e4), width=(2e-3, 6e-3))  # ten samples above half height
            s = replace(s, noise=0.0 if len(faults) == 1 else 2e-3)
            (verdict,) = judge_hits(cases.one_force(rng, s, **faults))
            found += any("overload" in r for r in verdict.reasons)
        assert found >= NUMBER - 2


@pytest.mark.parametrize(
    ("fault", "word", "least"),
    [
        ("clip", "overload", 0.95),
        ("cut", "cut off", 0.95),
        ("mute", "cut off", 0.75),
        ("drop", "drops out", 0.9),
    ],
)
def test_faults_of_the_response_are_found(rng, fault, word, least):
    found = 0
    for _ in range(NUMBER):
        s = cases.setting(rng, rate=(8e3, 5e4))
        (verdict,) = judge_hits(cases.one_response(rng, s, fault))
        found += any(word in r for r in verdict.reasons)
    assert found >= least * NUMBER


def test_responses_clipped_and_filtered_are_found_where_their_waves_are_sampled_well():
    time = np.arange(4000) / 10000
    wave = np.exp(-4 * time) * np.sin(2 * np.pi * 120 * time) + 0.1 * np.sin(2 * np.pi * 333 * time)
    smooth = np.convolve(np.clip(wave, -0.5, 0.5), np.hanning(9) / np.hanning(9).sum(), "same")
    assert flat_waves(smooth) and not flat_waves(wave)
    assert not flat_waves(np.sin(2 * np.pi * 50 * time))  # of one level, but round


def test_the_converters_limit_shows_over_all_hits(rng):
    found = clean = wrong = 0
    for _ in range(12):
        test, bad = cases.several(rng, cases.setting(rng), "limit")
        over = [any("overload" in r for r in v.reasons) for v in judge_hits(test)]
        found += sum(over[i] for i in bad) / len(bad) / 12
        wrong += sum(over[i] for i in range(5) if i not in bad)
        clean += sum(not v.used for v in judge_hits(cases.several(rng, cases.setting(rng), "")[0]))
    assert found > 0.9 and wrong == 0 and clean == 0


def test_copies_of_one_hit_have_no_common_limit():
    time = np.arange(1000.0)
    one = np.exp(-(((time - 300) / 20) ** 2))
    assert not at_common_limit([one, one.copy(), one.copy()]).any()
    assert at_common_limit([np.minimum(a * one, 1.0) for a in (0.5, 1.2, 1.5)]).tolist() == [
        False,
        True,
        True,
    ]


@pytest.mark.parametrize("fault", ["weak", "elsewhere"])
def test_the_odd_hit_of_five_is_found_and_no_other(rng, fault):
    found = wrong = 0
    for _ in range(15):
        test, bad = cases.several(rng, cases.setting(rng), fault)
        out = {v.hit - 1 for v in judge_hits(test) if not v.used}
        found, wrong = found + len(out & bad), wrong + len(out - bad)
    assert found >= 12 and wrong == 0


def test_pulses_of_odd_length_and_level_are_outliers(rng):
    s = replace(cases.setting(rng), rate=10e3, samples=6000, width=2e-3, noise=1e-3, offset=0.0)
    modes = [(60.0, 0.02, 1.0, 0.0)]
    motions = [cases.sampled(rng, s, cases.response(rng, s, modes=modes)) for _ in range(5)]
    forces = [cases.force(rng, replace(s, width=w)) for w in (2e-3, 2e-3, 4e-3, 2e-3, 2e-3)]
    verdicts = judge_hits(cases.test_of(s, forces, motions))
    assert [v.hit for v in verdicts if any("outlier in shape" in r for r in v.reasons)] == [3]
    forces = [a * cases.force(rng, s) for a in (1, 1, 1, 6, 1)]
    verdicts = judge_hits(cases.test_of(s, forces, motions))
    assert [v.hit for v in verdicts if any("outlier in level" in r for r in v.reasons)] == [4]


def test_offset_is_said_and_refuses_nothing(rng):
    s = replace(cases.setting(rng), noise=1e-3, offset=0.04)
    (verdict,) = judge_hits(cases.one_force(rng, s))
    assert verdict.used and any("offset of" in r for r in verdict.reasons)
    assert verdict.point == Dof(1, 3)


def test_a_bulge_on_the_flank_of_a_contact_is_no_second_hit():
    """Real tips give pulses that fall in two steps; the hammer has not left before the second."""
    time = np.arange(3000.0)
    x = np.clip((time - 1000) / 100, 0, 1)
    wave = np.sin(np.pi * x) ** 2 + 0.3 * np.exp(-(((time - 1085) / 12) ** 2)) * (x < 1) * (1 - x) ** 0.1
    assert second_hits(wave) == []


def test_averaging_over_a_period_takes_the_ringing_and_leaves_the_impulse():
    time = np.arange(4000.0)
    wave = np.sinc((time - 1500) / 7.3)  # an ideal filter: rings with a period of 14.6 samples
    period = ringing_period(wave)
    assert period == pytest.approx(14.6, rel=0.05)
    smooth, factor = without_ringing(wave, period)
    assert smooth.sum() / factor == pytest.approx(wave.sum(), rel=1e-3)
    away = np.abs(np.arange(len(smooth)) / factor - 1500) > 2 * period
    assert np.abs(smooth[away]).max() < 0.02 * smooth.max() < 0.1 * np.abs(wave[1515:1530]).max()


def test_drift_after_a_pulse_is_no_ringing():
    """A piezoelectric force transducer droops: the force goes below zero and comes back slowly."""
    time = np.arange(4000.0)
    pulse = np.where(np.abs(time - 500) < 20, np.cos(np.pi * (time - 500) / 40) ** 2, 0)
    droop = -0.05 * np.exp(-(time - 520) / 800) * (time > 520)
    assert ringing_period(pulse + droop) == 0.0
    assert second_hits(upright((pulse + droop)[None])[0]) == []


def test_what_has_died_away_is_neither_dead_nor_dropped():
    time = np.arange(8000) / 8000
    wave = np.exp(-30 * time) * np.sin(2 * np.pi * 90 * time)
    coarse = np.round(wave / 2**-9) * 2**-9  # the last half is zero, below half a step
    beat = np.sin(2 * np.pi * 100 * time) * np.sin(2 * np.pi * 2 * time)
    records = np.stack([wave, coarse, beat])
    assert dead_from(records).tolist() == [1, 1, 1] and dropouts(records).tolist() == [0, 0, 0]


def short_hits(rng, *, clip, decay, noise=0.02, rate=4096.0, width=2.4e-3):
    """Return five hits of which the third is clipped at a part of its peak, windowed after the converter."""
    time = np.arange(4096) / rate
    window = np.exp(-decay * time)
    forces, motions = [], []
    for number in range(5):
        start, peak = 0.02 * rng.uniform(0.95, 1.05), rng.uniform(40, 90)
        near = np.abs(time - start) < width / 2
        force = np.where(near, peak * np.cos(np.pi * (time - start) / width) ** 2, 0.0)
        force = force + rng.normal(0, noise, len(time))
        forces.append(window * (np.minimum(force, clip * peak) if number == 2 else force))
        ring = np.exp(-3 * (time - start)) * np.sin(2 * np.pi * 81 * (time - start)) * (time > start)
        motions.append(window * (peak * ring + rng.normal(0, 0.05, len(time))))
    hits = Hits(Dof(1, 3), (Dof(1, 3),), np.array(forces), np.array(motions)[:, None])
    return HammerTest(rate=rate, points=(hits,))


def clipped_hits(test):
    return [v.hit for v in judge_hits(test) if any("clipped" in r for r in v.reasons)]


@pytest.mark.parametrize("decay", [2.0, 9.0])
@pytest.mark.parametrize("clip", [0.5, 0.7])
def test_a_window_nobody_stated_does_not_hide_a_clipped_force(rng, decay, clip):
    """Its flat top falls by one ratio per sample; the hits beside it are no more suspect than without a window."""
    for _ in range(10):
        assert clipped_hits(short_hits(rng, clip=clip, decay=decay)) == [3]
        assert clipped_hits(short_hits(rng, clip=1.0, decay=decay)) == []


def test_a_slanted_top_tells_the_window_where_there_is_no_noise(rng):
    test = short_hits(rng, clip=0.5, decay=7.0, noise=0.0)
    assert unstated_window(test) == pytest.approx(7.0, rel=1e-6)
    assert unstated_window(short_hits(rng, clip=1.0, decay=7.0, noise=0.0)) is None
    assert clipped_hits(test) == [3]


@pytest.mark.long
def test_a_top_of_two_samples_is_clipped_where_the_steps_are_fine(rng):
    """At 2 kHz a pulse of 2.4 ms has five samples, and its clipped top two of them."""
    found = false = 0
    for _ in range(20):
        test = short_hits(rng, clip=0.7, decay=3.0, rate=2048.0)
        force = test.points[0].force[2] * np.exp(3.0 * np.arange(4096) / 2048.0)
        if (force > (1 - 1e-9) * force.max()).sum() == 2:
            found += clipped_hits(replace(test, decay=3.0)) == [3]
            false += clipped_hits(replace(short_hits(rng, clip=1.0, decay=3.0, rate=2048.0), decay=3.0)) != []
        else:
            found += 1
    assert found == 20 and false == 0


@pytest.mark.long
def test_windowed_clean_hits_of_any_chain_are_not_clipped(rng):
    """With the converter's steps of 16 bit and with none."""
    for number in range(3 * NUMBER):
        s = cases.setting(rng)
        test = cases.one_force(rng, s)
        (point,) = test.points
        step = np.abs(point.force).max() / 2**15 if number % 2 else 0.0
        force = np.round(point.force / step) * step if step else point.force
        window = np.exp(-3.0 * np.arange(s.samples) / s.samples)
        assert clipped_hits(replace(test, points=(replace(point, force=force * window),))) == []
