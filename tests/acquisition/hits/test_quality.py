"""Bad hits are found, good ones left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition import (
    Dof,
    HammerPlan,
    HammerTest,
    Hits,
    hammer_test,
    hits_table,
    judge_hits,
    modal_system,
    read_uff,
    rejected_points,
)
from acquisition.hits.checks import clipped, pulse_width, second_hits

SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0, 300.0]),
    damping=np.array([0.02, 0.015, 0.01]),
    response_shapes=np.array([[1.0, 0.7, 0.3], [0.4, -0.8, 0.5]]),
    point_shapes=np.array([[1.0, 0.7, 0.3], [0.2, 0.5, -0.9]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3), Dof(4, 3)),
)


@pytest.mark.parametrize("bits", [12, 16, 24])
@pytest.mark.parametrize("rate", [2048.0, 4096.0, 25600.0, 51200.0])
@pytest.mark.parametrize("pulse", ["haversine", "half-sine"])
def test_clean_pulses_of_one_to_six_milliseconds_raise_no_alarm(rng, rate, bits, pulse):
    for width in (1e-3, 2.5e-3, 6e-3):
        plan = HammerPlan(
            rate=rate,
            samples=int(1.5 * rate),
            hits=3,
            width=width,
            pulse=pulse,
            force_noise=0.02,
            response_noise=5e-4,
            adc_bits=bits,
        )
        verdicts = judge_hits(hammer_test(SYSTEM, plan, rng=rng))
        assert [v.reasons for v in verdicts if not v.used] == []


@pytest.mark.parametrize("low_pass", [0.02, 0.04, 0.1, 0.2])
@pytest.mark.parametrize("kind", ["butter", "ellip", "fir"])
def test_a_force_that_rings_is_no_double_hit(low_pass, kind):
    """Filters of eighth order or 401 taps, cut-off from far below the pulse's band on."""
    wave = np.zeros(4096)
    wave[1000:1026] = np.sin(np.pi * np.arange(26) / 26) ** 2
    if kind == "fir":
        rung = scipy.signal.lfilter(scipy.signal.firwin(401, low_pass, window="boxcar"), 1.0, wave)
    else:
        order = (
            scipy.signal.butter(8, low_pass, output="sos")
            if kind == "butter"
            else scipy.signal.ellip(8, 0.5, 80, low_pass, output="sos")
        )
        rung = scipy.signal.sosfilt(order, wave)
    assert second_hits(rung) == []


@settings(max_examples=60)
@given(
    height=st.floats(0.1, 1.0),
    delay=st.integers(60, 2000),
    width=st.floats(0.5, 2.0),
    noise=st.floats(0.0, 0.004),
)
def test_second_hits_of_a_tenth_are_found(height, delay, width, noise):
    generator = np.random.default_rng(1)
    time = np.arange(4096.0)

    def pulse(at: float, length: float):
        return np.where(np.abs(time - at) < length / 2, np.cos(np.pi * (time - at) / length) ** 2, 0.0)

    wave = (
        pulse(500, 40.0) + height * pulse(500 + delay, 40 * width) + noise * generator.standard_normal(4096)
    )
    found = second_hits(wave)
    assert any(abs(abs(place - 500 - delay)) < 10 or abs(place - 500) < 10 for place, _ in found)


def test_faults_are_named_and_nothing_else_is_refused(rng):
    bad = {(0, 1): "double", (0, 3): "clipped", (1, 0): "weak", (1, 4): "cut"}
    plan = HammerPlan(samples=8192, hits=7, force_noise=0.05, response_noise=1e-3, bad=bad)
    test = hammer_test(SYSTEM, plan, rng=rng)
    verdicts = judge_hits(test)
    refused = {(v.point, v.hit): v.reasons for v in verdicts if not v.used}
    words = {"double": "double hit", "clipped": "overload", "weak": "too weak", "cut": "cut off"}
    assert set(refused) == {(SYSTEM.points[p], h + 1) for p, h in bad}
    for (point, hit), kind in bad.items():
        assert any(words[kind] in reason for reason in refused[SYSTEM.points[point], hit + 1])
    table = hits_table(verdicts)
    assert len(table) == 14 and (~table["used"]).sum() == 4
    assert rejected_points(verdicts) == ()


def test_a_hit_beside_the_point_is_an_outlier(rng):
    test = hammer_test(SYSTEM, HammerPlan(samples=4096, response_noise=1e-3), rng=rng)
    here, there = test.points
    motion = np.array(here.motion)
    scale = here.force[2].max() / there.force[0].max()
    force = np.array(here.force)
    motion[2], force[2] = scale * there.motion[0], scale * there.force[0]
    swapped = replace(test, points=(Hits(here.reference, here.responses, force, motion), there))
    refused = [v for v in judge_hits(swapped) if not v.used]
    assert [(v.point, v.hit) for v in refused] == [(here.reference, 3)] and "outlier" in refused[0].reasons[0]


def test_undecayed_response_is_said_and_not_refused(rng):
    plan = HammerPlan(samples=1024)
    stated = judge_hits(hammer_test(SYSTEM, plan, rng=rng))
    windowed = judge_hits(hammer_test(SYSTEM, replace(plan, decay=20.0), rng=rng))
    assert all(v.used and any("left at the end" in r for r in v.reasons) for v in stated)
    assert all(v.used and v.reasons == () for v in windowed)


def test_peak_width_and_bands_are_those_of_the_pulse(rng):
    """A haversine: half its height at half its width, -6 dB at 1 / width; 10 and 20 dB from its transform."""
    plan = HammerPlan(rate=51200.0, samples=8192, hits=1, width=4e-3, width_scatter=0.0, level_scatter=0.0)
    (verdict, _) = judge_hits(hammer_test(SYSTEM, plan, rng=rng))
    assert verdict.peak == pytest.approx(100.0, rel=1e-3)
    assert verdict.width == pytest.approx(4e-3 * np.arccos(2 * 0.1 - 1) / np.pi, rel=0.01)
    f = np.linspace(1.0, 500.0, 5000) * 4e-3
    size = np.abs(np.sinc(f) / (1 - f**2 + 1e-15))
    for band, decibels in ((verdict.band10, 10), (verdict.band20, 20)):
        assert band == pytest.approx(f[np.argmax(size < 10 ** (-decibels / 20))] / 4e-3, rel=0.03)


def test_polarity_and_units_of_the_force_do_not_matter(rng):
    test = hammer_test(SYSTEM, HammerPlan(samples=4096, bad={(0, 1): "double"}), rng=rng)
    points = tuple(Hits(p.reference, p.responses, -1e-3 * p.force, 50 * p.motion) for p in test.points)
    one, two = judge_hits(test), judge_hits(HammerTest(test.rate, points))
    assert [v.used for v in one] == [v.used for v in two]
    assert np.allclose([v.peak for v in one], [1e3 * v.peak for v in two], rtol=1e-3)


@pytest.mark.parametrize("at", [0.5, 0.8, 0.95])
def test_flat_tops_are_overload_and_round_ones_are_not(at):
    time = np.arange(2000) / 5000
    wave = np.exp(-8 * time) * np.sin(2 * np.pi * 60 * time)
    assert clipped(
        np.stack([wave, np.clip(wave, -at, at) if at < wave.max() else np.minimum(wave, 0.9 * wave.max())])
    ).tolist() == [
        False,
        True,
    ]


def test_pulse_width_does_not_depend_on_the_rate():
    widths = []
    for rate in (5e3, 2e4, 1e5):
        time = np.arange(0, 0.1, 1 / rate) - 0.0301
        widths.append(pulse_width(np.where(np.abs(time) < 2e-3, np.cos(np.pi * time / 4e-3) ** 2, 0.0), rate))
    assert np.ptp(widths) < 0.02 * widths[0]


def test_real_hits_are_used_and_their_bands_are_those_reported(shared_data):
    """Five hits with a pulse that falls in two steps; 10 dB down at 3.7 kHz and 20 dB at 7.2 kHz over all."""
    (test,) = read_uff(shared_data("impacts/pyFRF/hits.uff")).tests
    verdicts = judge_hits(test)
    assert [v.used for v in verdicts] == [True] * 5
    assert all(69 - 1 < v.peak < 89 + 1 for v in verdicts)
    assert np.mean([v.band10 for v in verdicts]) == pytest.approx(3700, rel=0.08)
    assert np.mean([v.band20 for v in verdicts]) == pytest.approx(7200, rel=0.04)
