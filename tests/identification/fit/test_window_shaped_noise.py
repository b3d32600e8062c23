"""Noise that an exponential window makes fade along the record: no modes of its own, and honest sigmas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import column, structure

from acquisition.frfs.frf import FrfSet
from identification import identify
from identification.fit.noise import window_shaped

SAMPLES, RATE = 4096, 1600.0


def spectra(rng, fade: float, n_frf: int, n_lines: int):
    """Lines 1 ... n of white records of unit variance under exp(-fade t / T), scaled to unit mean square."""
    time = np.arange(SAMPLES) / SAMPLES
    records = rng.standard_normal((n_frf, SAMPLES)) * np.exp(-fade * time)
    found = np.fft.rfft(records, axis=1)[:, 1 : n_lines + 1]
    return found / np.sqrt(SAMPLES * np.mean(np.exp(-2 * fade * time)))


def windowed_test(truth, rng, *, fade: float, noise: float, n_points: int = 6, n_lines: int = 1200) -> FrfSet:
    """FRFs whose structure and whose noise bear the same window; noise relative to the largest value."""
    df = RATE / SAMPLES
    frequency = df * np.arange(1, n_lines + 1)
    clean = truth.frfs(frequency, column(n_points), decay=fade * df)
    level = noise * np.abs(clean.values).max(axis=1, keepdims=True)
    return replace(clean, values=clean.values + level * spectra(rng, fade, n_points, n_lines))


@pytest.mark.parametrize("fade", [2.0, 3.0, 8.0, 20.0])
def test_the_fading_is_measured_under_any_level(fade, rng):
    dirt = spectra(rng, fade, 6, 1500) * np.geomspace(1e-6, 1e3, 6)[:, None]
    assert window_shaped.decay_over_record(dirt) == pytest.approx(fade, rel=0.1)


def test_steady_noise_is_not_said_to_fade():
    found = [
        window_shaped.decay_over_record(spectra(np.random.default_rng(seed), 0.0, n, 800))
        for seed in range(40)
        for n in (1, 6)
    ]
    assert np.count_nonzero(found) <= 1


def test_a_mode_left_out_is_not_taken_for_fading():
    truth = structure((45.0, 200.0), (0.01, 0.002), 6, seed=3)
    wrong = 0
    for seed in range(10):
        frfs = windowed_test(truth, np.random.default_rng(seed), fade=0.0, noise=1e-3)
        wrong += window_shaped.decay_over_record(frfs.values) > 2.0
    assert wrong == 0


@pytest.mark.parametrize("decay", [0.5, 4.0, 30.0])
def test_inflation_is_that_of_least_squares_in_the_time_domain(decay):
    fade, samples = 5.0, 8000
    u = (np.arange(samples) + 0.5) / samples
    columns = np.stack([np.exp(-decay * u), u * np.exp(-decay * u)], axis=1)
    variance = np.exp(-2 * fade * u)
    variance /= variance.mean()

    def spread(basis):
        inverse = np.linalg.inv(basis.T @ basis)
        return np.diag(inverse @ (basis.T * variance) @ basis @ inverse) / np.diag(inverse)

    held, free, pole = window_shaped.inflation(fade, np.array([decay]))
    both = spread(columns)
    np.testing.assert_allclose(
        [held[0], free[0], pole[0]], [spread(columns[:, :1])[0], both[0], both[1]], rtol=2e-3
    )


@pytest.mark.long
def test_windowed_noise_makes_no_modes_and_sigmas_hold():
    truth = structure((40.0, 120.0, 230.0, 380.0), (0.008, 0.004, 0.003, 0.002), 6, seed=11)
    frequency, damping = [], []
    for seed in range(24):
        fade = (3.0, 6.0, 10.0)[seed % 3]
        model = identify(windowed_test(truth, np.random.default_rng(500 + seed), fade=fade, noise=3e-3))
        assert len(model) == 4, model.table()
        frequency.append((model.modal.frequency - truth.hertz) / model.modal.frequency_sigma)
        damping.append((model.modal.damping - truth.damping) / model.modal.damping_sigma)
    for score in (np.concatenate(frequency), np.concatenate(damping)):
        assert 0.9 < np.mean(np.abs(score) < 1.96) < 0.99
