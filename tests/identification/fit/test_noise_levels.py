"""Noise levels from differences, from residuals, and from coherence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import column, lines, structure

from identification import identify
from identification.fit.noise import levels


def dirt(rng, shape):
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)


def test_scatter_is_blind_to_what_is_smooth(rng):
    x = np.linspace(0, 1, 2000)
    values = 0.3 * dirt(rng, (5, 2000)) + 50 * np.exp(3j * x)
    np.testing.assert_allclose(levels.scatter(values), 0.09, rtol=0.2)


def resonances(count):
    """FRFs with narrow peaks, the same for all."""
    x = np.linspace(0, 1, 3000)
    return np.tile(sum(1 / (x - c + 0.002j) for c in (0.2, 0.5, 0.9)), (count, 1))


def test_noise_of_the_force_grows_with_the_frf(rng):
    model = resonances(6)
    sigma = np.hypot(2.0, 0.02 * np.abs(model))
    weights, variance = levels.from_residual(
        sigma * dirt(rng, (6, 3000)), np.zeros((1, 3000)), np.zeros((6, 1)), model
    )
    assert weights.lines.shape == (6, 3000)
    np.testing.assert_allclose(variance, sigma**2, rtol=0.35)
    assert abs(np.mean(variance / sigma**2) - 1) < 0.03


def test_white_noise_gives_one_weight_per_frf(rng):
    level = np.array([[1.0], [4.0], [0.1]])
    weights, variance = levels.from_residual(
        level * dirt(rng, (3, 3000)), np.zeros((1, 3000)), np.zeros((3, 1)), resonances(3)
    )
    assert weights.lines.shape == (1, 3000)
    assert np.ptp(weights.lines) == 0
    np.testing.assert_allclose(variance[:, 0], level[:, 0] ** 2, rtol=0.08)


def test_a_colour_in_common_is_found(rng):
    colour = np.linspace(0.2, 3.0, 3000)
    weights, variance = levels.from_residual(
        colour * dirt(rng, (8, 3000)), np.zeros((1, 3000)), np.zeros((8, 1)), resonances(8)
    )
    assert weights.lines.shape == (1, 3000)
    middle = slice(300, 2700)
    np.testing.assert_allclose(variance[:, middle].mean(axis=0), (colour**2)[middle], rtol=0.25)


def test_colours_of_their_own_are_found(rng):
    colour = np.stack([np.linspace(0.2, 3.0, 3000), np.linspace(3.0, 0.2, 3000)])
    weights, _ = levels.from_residual(
        colour * dirt(rng, (2, 3000)), np.zeros((1, 3000)), np.zeros((2, 1)), resonances(2)
    )
    assert weights.lines.shape == (2, 3000)


def test_noise_of_the_force_beside_a_colour(rng):
    model, colour = resonances(6), np.linspace(0.2, 3.0, 3000)
    sigma = np.hypot(colour, 0.02 * np.abs(model))
    weights, variance = levels.from_residual(
        sigma * dirt(rng, (6, 3000)), np.zeros((1, 3000)), np.zeros((6, 1)), model
    )
    assert weights.unknowns == pytest.approx(3000 / 250)
    middle = slice(300, 2700)
    np.testing.assert_allclose(variance[:, middle], (sigma**2)[:, middle], rtol=0.35)


def test_a_colour_that_is_not_there_is_not_worth_its_price(rng):
    level, law = np.array([[1.0], [4.0], [0.1]]), np.abs(resonances(3)) ** 2
    variance = level**2 + 0.01 * law
    power = variance * np.abs(dirt(rng, (3, 3000))) ** 2
    found, numbers = levels.of_two_sources(power, law, level[:, 0])
    assert numbers == 1.0
    np.testing.assert_allclose(found, variance, rtol=0.15)


def test_errors_are_at_most_those_of_one_block(rng):
    """Averages of less than a block do not exist: what errs by more than one would is no leakage."""
    law = np.abs(resonances(3)) ** 2
    power = (1.0 + 100.0 * law) * np.abs(dirt(rng, (3, 3000))) ** 2
    found, _ = levels.of_two_sources(power, law, np.ones(3))
    peak = law[0].argmax()
    assert found[0, peak] - found[0, peak + 100] < 1.01 * (law[0, peak] - law[0, peak + 100])


def test_a_line_without_force_does_not_raise_the_noise_of_all(rng):
    ratio = 0.01 * np.abs(dirt(rng, (3, 2000))) ** 2
    ratio[:, -1] = 1e3
    np.testing.assert_allclose(levels.usual(ratio), 0.01, rtol=0.1)


def test_coherence_alone_is_a_relative_weight(rng):
    truth = structure((50.0, 90.0), (0.01, 0.01), 5, seed=10)
    clean = truth.frfs(lines(high=150.0), column(5))
    spread = 0.02 * np.sqrt(np.mean(np.abs(clean.values) ** 2)) * np.where(clean.frequency > 70, 5.0, 1.0)
    values = clean.values + spread * dirt(rng, clean.values.shape)
    power = np.abs(clean.values) ** 2
    coherence = power / (power + spread**2)
    model = identify(replace(clean, values=values, coherence=coherence))
    plain = identify(replace(clean, values=values))
    assert np.abs((model.modal.frequency - truth.hertz) / model.modal.frequency_sigma).max() < 4
    np.testing.assert_allclose(model.modal.frequency_sigma, plain.modal.frequency_sigma, rtol=0.25)


@pytest.mark.parametrize(("n_lines", "window"), [(100, 48), (48, 48), (801, 66), (5, 5), (9, 2), (10, 1)])
def test_a_local_mean_is_that_of_its_window(n_lines, window):
    power = np.random.default_rng(0).random((3, n_lines))
    mirrored = np.concatenate([power[:, ::-1], power, power[:, ::-1]], axis=1)
    first = n_lines - window // 2 + np.arange(n_lines)
    expected = np.stack([mirrored[:, i : i + window].mean(axis=1) for i in first], axis=1)
    np.testing.assert_allclose(levels.local_mean(power, window), expected, rtol=1e-13)


def test_a_local_mean_of_small_values_does_not_feel_large_ones_elsewhere():
    # Without noise, what a line says of common noise changes by 1e18 along the band.
    power = np.full((1, 400), 3.0)
    power[0, 100:150] = 1e22
    np.testing.assert_allclose(levels.local_mean(power, 48)[0, 200:], 3.0, rtol=1e-13)
