"""Lines of noise alone, by phases."""

from __future__ import annotations

import numpy as np
import pytest

from identification.band.phases import STRETCH, noise_lines

LINES = np.arange(1.0, 1201.0)


def response(width: float, spacing: float) -> np.ndarray:
    """Return six FRFs with peaks of one width, with spacing between [lines]."""
    rng = np.random.default_rng(1)
    poles = -width / 2 + 1j * np.arange(0.4 * spacing, 1200.0, spacing)
    shapes = rng.standard_normal((6, len(poles)))
    s = 1j * LINES[:, None]
    return shapes @ (s**2 / ((s - poles) * (s - poles.conj()))).T


def smoothed(values: np.ndarray) -> np.ndarray:
    return 0.25 * values[:, :-2] + 0.5 * values[:, 1:-1] + 0.25 * values[:, 2:]


def noise(seed: int, n_frf: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.standard_normal((n_frf, 1200)) + 1j * rng.standard_normal((n_frf, 1200))


@pytest.mark.parametrize("n_frf", [1, 6])
@pytest.mark.parametrize("seed", range(5))
def test_noise_is_found_where_it_begins_however_large_it_is(seed: int, n_frf: int) -> None:
    values = response(3.0, 90.0)[:n_frf]
    loud = noise(seed, n_frf) * np.abs(noise(seed + 100, n_frf)) ** -2  # as over a force of next to nothing
    values[:, 900:] = 1e4 * loud[:, 900:]
    found = noise_lines(values)
    first = int(np.flatnonzero(found)[0])
    assert 900 - STRETCH < first <= 900 + STRETCH // 8 and found[first:].all()


@pytest.mark.parametrize("seed", range(5))
def test_smoothed_noise_is_noise(seed: int) -> None:
    assert noise_lines(smoothed(noise(seed, 6))).all()


@pytest.mark.parametrize(
    ("width", "spacing"), [(0.1, 100.0), (1.0, 30.0), (1.0, 4.0), (3.0, 4.0), (30.0, 40.0)]
)
def test_no_peak_passes_for_noise(width: float, spacing: float) -> None:
    values = response(width, spacing)
    assert not noise_lines(values).any()
    assert not noise_lines(smoothed(values)).any()
    assert not noise_lines(values.conj()).any()


@pytest.mark.parametrize("mute", range(1, 6))
def test_a_mode_that_few_frfs_show_is_none_of_the_noise_in_the_others(mute: int) -> None:
    values = response(3.0, 60.0)
    values[:mute, 900:] = noise(0, mute)[:, 900:]
    assert not noise_lines(values).any()


def test_an_frf_of_zeros_shows_nothing() -> None:
    values = response(3.0, 90.0)
    values[:, 900:] = noise(0, 6)[:, 900:]
    values[:3] = 0.0
    found = noise_lines(values)
    assert not found[: 900 - STRETCH].any() and found[900:].all()


def test_few_lines_are_not_judged() -> None:
    assert not noise_lines(noise(0, 6)[:, : STRETCH + 4]).any()
