"""Orders are raised where the modes of a band crowd the stabilisation chart."""

import numpy as np
import pytest

from acquisition import Dof, FrfSet
from identification.orders import charted, directions
from identification.poles import ESTIMATORS

BAND = (100.0, 500.0)


def crowded(rng, *, modes, points=60, references=3, lines=1200):
    """Return FRFs of many modes at many points, and their frequencies [Hz]."""
    hertz = np.linspace(105.0, 495.0, modes) + rng.uniform(-2.0, 2.0, modes)
    damping = rng.uniform(0.002, 0.004, modes)
    omega = 2 * np.pi * hertz
    poles = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    shapes = rng.standard_normal((points, modes))
    frequency = np.linspace(*BAND, lines)
    s = 2j * np.pi * frequency
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    values = np.concatenate([(shapes * shapes[r]) @ terms.T * s**2 for r in range(references)])
    noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    responses = tuple(Dof(i + 1, 3) for _ in range(references) for i in range(points))
    fixed = tuple(Dof(r + 1, 3) for r in range(references) for _ in range(points))
    return FrfSet(frequency, values + noise[0] + 1j * noise[1], responses, fixed), hertz


def found(start, hertz):
    """Return how many of the modes are among the candidates."""
    return int((np.abs(np.abs(start)[:, None] / (2 * np.pi) / hertz - 1) < 2e-3).any(axis=0).sum())


@pytest.mark.parametrize("modes", [8, 42, 60])
@pytest.mark.parametrize("points", [25, 100])
def test_each_mode_is_one_direction_of_the_frfs(rng, modes, points):
    frfs, _ = crowded(rng, modes=modes, points=points)
    assert modes <= directions(frfs) <= modes + 2


@pytest.mark.long
@pytest.mark.parametrize("modes", [42, 60])
def test_many_modes_of_many_points_are_all_candidates(rng, modes):
    frfs, hertz = crowded(rng, modes=modes)
    chart, start = charted(frfs, ESTIMATORS["lscf"], band=BAND, order=None)
    assert found(start, hertz) == modes
    assert 3 * chart.orders[-1] > 60


def test_an_order_that_is_given_stays(rng):
    frfs, hertz = crowded(rng, modes=42)
    chart, start = charted(frfs, ESTIMATORS["lscf"], band=BAND, order=60)
    assert 3 * chart.orders[-1] == 60
    assert found(start, hertz) < 42


def test_few_modes_need_no_higher_order(rng):
    frfs, hertz = crowded(rng, modes=8)
    chart, start = charted(frfs, ESTIMATORS["lscf"], band=BAND, order=None)
    assert 3 * chart.orders[-1] == 60
    assert found(start, hertz) == 8


def test_an_order_is_raised_only_as_far_as_the_lines_carry_it(rng):
    frfs, _ = crowded(rng, modes=42, lines=50)
    chart, _ = charted(frfs, ESTIMATORS["lscf"], band=BAND, order=None)
    assert chart.orders[-1] <= 25
