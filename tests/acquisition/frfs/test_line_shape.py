"""The line shape of a Hann window, beside quadrature and beside averages of a random force."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import FrfSet, InputError, LineShape
from acquisition.dof import Dof

DISTANCE = np.array([3 - 5j, 0.2 + 0.1j, 0.5 - 2j * np.pi, 20 + 100j, 0.01 + 4j * np.pi])


def hann_autocorrelation(count=1001):
    """Return lags and the autocorrelation of a Hann window of unit length, by the trapezoidal rule."""
    t = np.linspace(0, 1, 20001)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * t)
    lags = np.arange(count) * (len(t) - 1) // (count - 1)
    power = np.array([window[: len(t) - k] @ window[k:] for k in lags]) / (window @ window)
    return lags / (len(t) - 1), power


def test_averages_have_the_transform_of_the_windows_autocorrelation():
    u, power = hann_autocorrelation()
    value, slope = LineShape("averaged", 2.0).pole(DISTANCE)
    decay = np.exp(-2.0 * DISTANCE[:, None] * u) * power
    assert value == pytest.approx(2.0 * np.trapezoid(decay, u, axis=1), abs=1e-3)
    assert slope == pytest.approx(4.0 * np.trapezoid(decay * u, u, axis=1), abs=1e-3)


def test_smoothed_lines_are_means_of_three():
    value, _ = LineShape("smoothed", 0.5).pole(DISTANCE)
    step = 2j * np.pi / 0.5
    mean = 0.25 / (DISTANCE - step) + 0.5 / DISTANCE + 0.25 / (DISTANCE + step)
    assert value == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize("kind", ["averaged", "smoothed"])
def test_derivative_by_the_pole(kind):
    shape, step = LineShape(kind, 0.7), 1e-5
    up, down = shape.pole(DISTANCE - step)[0], shape.pole(DISTANCE + step)[0]
    assert shape.pole(DISTANCE)[1] == pytest.approx((up - down) / (2 * step), rel=1e-6, abs=1e-8)


def test_an_unknown_window_is_refused():
    with pytest.raises(InputError, match="unknown window 'flat'"):
        FrfSet(np.arange(1.0, 9.0), np.ones((1, 8)), (Dof(1, 3),), (Dof(1, 3),), window="flat")
