"""A band that is given is cut to where the FRFs carry information, and that is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet, HammerTest, UffContent, estimate_frfs, hammer_test, judge_hits
from acquisition.synthetic import HammerPlan, modal_system
from identification import informed_band
from modalkit.workflow.judged_hits import Judged
from modalkit.workflow.processed import Processed
from modalkit.workflow.processing_options import ProcessingOptions

FREQUENCIES = np.array([60.0, 151.0, 288.0, 417.0, 530.0])
SYSTEM = modal_system(
    frequency=FREQUENCIES,
    damping=np.full(5, 0.005),
    response_shapes=np.array([[1.0, 0.8, -0.6, 0.9, 0.7]]),
    point_shapes=np.array([[1.0, 0.8, -0.6, 0.9, 0.7], [-0.5, 0.9, 0.8, -0.4, 0.6]]),
    responses=[Dof(1, 3)],
    points=[Dof(1, 3), Dof(2, 3)],
)


def hit(**more: object) -> tuple[FrfSet, HammerTest]:
    plan = replace(
        HammerPlan(rate=2048.0, samples=2048, hits=4, force_noise=0.1, response_noise=1e-3), **more
    )  # type: ignore[arg-type]
    test = hammer_test(SYSTEM, plan, rng=np.random.default_rng(2))
    return estimate_frfs(test), test


@pytest.mark.parametrize("hits", [1, 4])
def test_a_band_beyond_the_force_ends_where_the_force_does(hits: int) -> None:
    """The spectrum of a haversine of 5 ms is zero at 400 Hz and every 200 Hz from there."""
    frfs, test = hit(width=5e-3, width_scatter=0.01, hits=hits)
    (low, high), message = informed_band(frfs, [(test, ())], (20.0, 1000.0))
    assert low == 20.0 and 330 < high < 420
    assert message is not None and "to 1000 Hz as asked" in message and "harder tip" in message
    assert "carry information again" in message  # the first side lobe of the force


def test_a_band_that_the_force_reaches_is_left_alone() -> None:
    frfs, test = hit(width=1e-3, force_noise=0.01)
    assert informed_band(frfs, [(test, ())], (20.0, 700.0)) == ((20.0, 700.0), None)
    frfs, test = hit(width=3e-3, force_noise=1e-4, response_noise=1e-6)  # weak, but clean: worth what it says
    assert informed_band(frfs, [(test, ())], (20.0, 620.0)) == ((20.0, 620.0), None)


def test_a_band_to_the_nyquist_frequency_ends_in_the_fall_of_the_filter() -> None:
    frfs, test = hit(width=3e-4, force_noise=1e-4, response_noise=1e-6)
    (_, high), message = informed_band(frfs, [(test, ())], (20.0, 1024.0))
    assert 2048 / 2.56 < high < 0.49 * 2048 and message is not None and "filter" in message


def test_frfs_that_were_read_end_where_coherence_does_not_come_back() -> None:
    frfs, _ = hit(width=5e-3, width_scatter=0.01, force_noise=0.5)
    (_, high), message = informed_band(frfs, [], (20.0, 1000.0))
    assert high < 700 and message is not None and "coherence" in message


def test_frfs_without_coherence_end_where_their_phases_are_those_of_noise() -> None:
    frfs, _ = hit(width=5e-3, width_scatter=0.01, force_noise=0.5)
    (_, coherent), _ = informed_band(frfs, [], (20.0, 1000.0))
    bare = replace(frfs, coherence=None, variance=None, scatter=None)
    (low, high), message = informed_band(bare, [], (20.0, 1000.0))
    assert low == 20.0 and abs(high - coherent) < 32 and message is not None and "phases" in message
    clean = hit(width=3e-4, force_noise=1e-3)[0].band(1.0, 800.0)  # up to the filter
    assert informed_band(replace(clean, coherence=None, variance=None), [], None) == (None, None)


@pytest.mark.long
@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("seed", range(2))
def test_averages_whose_force_ends_below_the_lines_need_no_band(seed: int, noise: float) -> None:
    """Hann averages of a random force up to 900 of 1024 Hz, noise on the responses, and on the force or not."""
    model = Processed(UffContent(), averages(noise, seed), (), ProcessingOptions(), ()).identify()
    np.testing.assert_allclose(model.modal.frequency, FREQUENCIES, rtol=1e-3)
    assert model.modal.damping is not None and model.modal.damping_sigma is not None
    assert np.max(np.abs(model.modal.frequency - FREQUENCIES) / model.modal.frequency_sigma) < 3.0
    assert np.max(np.abs(model.modal.damping - 0.005) / model.modal.damping_sigma) < 3.0
    assert model.band[1] < 900 and any("the lines go from" in w for w in model.warnings)


def averages(force_noise: float, seed: int) -> FrfSet:
    """Average FRFs over 60 half-overlapping blocks of a second with a Hann window."""
    rng, samples = np.random.default_rng(seed), 2048
    length = 34 * samples
    s = 2j * np.pi * np.fft.rfftfreq(length, 1 / 2048)
    force = np.fft.rfft(rng.standard_normal(length)) * (np.abs(s) < 2 * np.pi * 900)
    window = np.hanning(samples + 1)[:-1]

    def spectra(line: np.ndarray, noise: float) -> np.ndarray:
        wave = np.fft.irfft(line, length)
        wave = wave + noise * np.std(wave) * rng.standard_normal(length)
        starts = range(4 * samples, length - samples + 1, samples // 2)
        return np.array([np.fft.rfft(window * wave[a : a + samples])[1:] for a in starts])

    push = spectra(force, force_noise)
    motion = [
        spectra(np.append(0.0, SYSTEM.receptance(s[1:], point)[0] * s[1:] ** 2) * force, 1e-3)
        for point in (0, 1)
    ]
    values = [np.sum(m * push.conj(), axis=0) / np.sum(np.abs(push) ** 2, axis=0) for m in motion]
    return FrfSet(np.arange(1.0, 1025.0), np.array(values), (Dof(1, 3),) * 2, (Dof(1, 3), Dof(2, 3)))


def test_no_mode_is_found_beyond_the_force_and_the_user_hears_of_it() -> None:
    frfs, test = hit(width=5e-3, width_scatter=0.01)
    processed = Processed(UffContent(), frfs, (Judged(test, judge_hits(test)),), ProcessingOptions(), ())
    model = processed.identify(band=(20.0, 1000.0))
    np.testing.assert_allclose(model.modal.frequency, FREQUENCIES[:3], rtol=1e-3)
    assert any("as asked" in w for w in model.warnings)


def test_a_mode_just_above_a_cut_band_does_not_pass_for_one_at_its_edge() -> None:
    """The noise of the force hides the mode at 870 Hz, whose flank reaches into the band as cut."""
    frequencies = np.append(FREQUENCIES, 870.0)
    shapes = np.array([[1.0, 0.8, -0.6, 0.9, 0.7, 0.9], [-0.5, 0.9, 0.8, -0.4, 0.6, 0.5]])
    system = modal_system(
        frequency=frequencies,
        damping=np.full(6, 0.005),
        response_shapes=shapes[:1],
        point_shapes=shapes,
        responses=[Dof(1, 3)],
        points=[Dof(1, 3), Dof(2, 3)],
    )
    plan = HammerPlan(
        rate=2048.0,
        samples=2048,
        hits=1,
        width=3e-4,
        anti_alias="sharp",
        force_noise=0.3,
        response_noise=1e-3,
    )
    test = hammer_test(system, plan, rng=np.random.default_rng(2))
    processed = Processed(
        UffContent(), estimate_frfs(test), (Judged(test, judge_hits(test)),), ProcessingOptions(), ()
    )
    model = processed.identify(band=(20.0, 1000.0))
    np.testing.assert_allclose(model.modal.frequency, FREQUENCIES, rtol=1e-3)
    assert any("as asked" in w for w in model.warnings)
