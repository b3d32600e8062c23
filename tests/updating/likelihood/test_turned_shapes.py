"""What scatters the frequencies of close modes turns their shapes into each other: against a solved eigenproblem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import PLATE, STEEL, blank, exactly

from acquisition.arrays import FloatArray
from updating import Case, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.close_modes import CloseModes
from updating.models.state import State

MODES, SCATTER = 4, 5e-4
SQUARE = Spec(
    "plate",
    length=0.3,
    width=0.302,
    thickness=0.003,
    elements=(10, 10),
    clamped=(),
    theory="kirchhoff",
    material=STEEL,
    damping=PLATE.damping,
)
"""Free and nearly square: its third and fourth bending modes are close."""


def setting_of(kept: list[int]) -> Setting:
    x, y = np.meshgrid([0.02, 0.11, 0.19, 0.28], [0.01, 0.12, 0.2, 0.29], indexing="ij")
    evaluation = Predictor(SQUARE, blank(np.stack([x.ravel(), y.ravel()], axis=1)))
    truth = evaluation.predict(count=5).select(np.array(kept))
    measured = exactly(evaluation, truth, sigma=1e-6, repeatability=SCATTER)
    return pose(Case("a plate", SQUARE, measured, tolerances=Tolerances({"E": 0.01})))[0].setting


@pytest.fixture(scope="module")
def setting() -> Setting:
    return setting_of([0, 1, 2, 3, 4])


def turns(setting: Setting) -> CloseModes:
    return CloseModes(setting, np.zeros(len(setting.measured.frequency)))


def columns(setting: Setting) -> FloatArray:
    now = setting.nominal
    found = turns(setting).columns(now, np.ones_like(now.constants))
    return found.reshape(*now.constants.shape, -1)


def test_a_column_is_what_a_small_coupling_of_two_modes_does(setting: Setting) -> None:
    (first, second), angle = turns(setting)._pairs
    closest = int(np.argmax(angle))
    i, j = int(first[closest]), int(second[closest])
    now, predictor = setting.nominal, setting.predictor
    mass = predictor.reduced.matrices(State())[1]
    left, right = (mass[:, : len(now.vectors)] @ now.vectors[:, m] for m in (i, j))
    omega = 2 * np.pi * now.frequency
    coupling = 1e-3 * 2 * SCATTER * omega[i] * omega[j]
    change = coupling * (np.outer(left, right) + np.outer(right, left))
    coupled = predictor.predict(State(stiffness=(change,)), count=len(omega))
    moved = (coupled.constants - now.constants)[:, [i, j]]
    expected = 1e-3 * columns(setting)[:, [i, j], closest]
    assert np.abs(moved).max() > 0
    sign = np.sign(np.sum(moved * expected))
    assert sign * moved == pytest.approx(expected, rel=0.02, abs=0.01 * np.abs(expected).max())


def test_a_shape_turns_as_much_into_a_mode_that_the_test_misses(setting: Setting) -> None:
    (first, second), angle = turns(setting)._pairs
    closest = int(np.argmax(angle))
    kept, missed = int(first[closest]), int(second[closest])
    left_out = setting_of([m for m in range(5) if m != missed])
    whole, found = columns(setting)[:, kept, closest], columns(left_out)[:, kept]
    same = np.abs(found.T - whole).max(axis=1) < 0.01 * np.abs(whole).max()
    opposite = np.abs(found.T + whole).max(axis=1) < 0.01 * np.abs(whole).max()
    assert np.count_nonzero(same | opposite) == 1


def test_distant_modes_stay_as_sharp_as_they_are(setting: Setting) -> None:
    test = setting.measured
    (first, second), angle = turns(setting)._pairs
    assert 0 < len(angle) < 10
    for a, b, turn in zip(first, second, angle, strict=True):
        apart = abs(np.log(test.frequency[b] / test.frequency[a]))
        assert turn == pytest.approx(SCATTER / apart, rel=0.05)


@settings(max_examples=8)
@given(st.lists(st.sampled_from([-1.0, 1.0]), min_size=5, max_size=5))
def test_a_shape_that_is_turned_round_changes_nothing(setting: Setting, signs: list[float]) -> None:
    now = setting.nominal
    level = np.ones_like(now.constants)
    sign = np.resize(signs, now.seen.shape[1])
    other = replace(now, seen=now.seen * sign, hit=now.hit * sign)
    assert turns(setting).columns(other, level) == pytest.approx(turns(setting).columns(now, level))


def test_what_is_read_with_a_gain_turns_with_it(setting: Setting) -> None:
    now = setting.nominal
    quieter = setting.predictor.predict(State(gain=0.7), count=now.constants.shape[1])
    level = np.ones_like(now.constants)
    assert np.abs(quieter.constants) == pytest.approx(0.7 * np.abs(now.constants))
    found, whole = (np.abs(turns(setting).columns(one, level)) for one in (quieter, now))
    assert found == pytest.approx(0.7 * whole)


def test_modes_known_to_the_last_digit_do_not_turn(setting: Setting) -> None:
    sharp = replace(setting, measured=replace(setting.measured, repeatability=0.0))
    assert turns(sharp).columns(setting.nominal, np.ones_like(setting.nominal.constants)).size == 0
