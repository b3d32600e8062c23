"""A mode that is missed leaves its constants in those of its neighbour: against a fit of one pole where two are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, STEEL, blank, exactly

from updating import Case, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.missed_modes import MissedModes

SQUARE = Spec(
    "plate",
    length=0.3,
    width=0.31,
    thickness=0.003,
    elements=(10, 10),
    clamped=(),
    theory="kirchhoff",
    material=STEEL,
    damping=PLATE.damping,
)
"""Free and nearly square: its third and fourth bending modes are close."""
MISSED, NEIGHBOUR, LOSS = 4, 3, 0.01


def setting(kept: list[int]) -> Setting:
    x, y = np.meshgrid([0.02, 0.11, 0.19, 0.28], [0.01, 0.12, 0.2, 0.29], indexing="ij")
    predictor = Predictor(SQUARE, blank(np.stack([x.ravel(), y.ravel()], axis=1)))
    truth = predictor.predict(count=6).select(np.array(kept))
    measured = exactly(predictor, truth, sigma=1e-6, damping=np.full(len(kept), LOSS))
    return pose(Case("a plate", SQUARE, measured, tolerances=Tolerances({"E": 0.01})))[0].setting


@pytest.fixture(scope="module")
def without() -> Setting:
    return setting([m for m in range(6) if m != MISSED])


def change(setting: Setting) -> np.ndarray:
    now = setting.nominal
    found = MissedModes(setting).columns(now, np.ones_like(now.constants))
    return found.reshape(*now.constants.shape, -1)


@pytest.mark.long
def test_constants_change_as_those_of_one_pole_that_is_fitted_to_two(without: Setting) -> None:
    own, lost = without.nominal, without.missed
    frequency = np.array([own.frequency[NEIGHBOUR], lost.frequency[0]])
    assert lost.frequency[0] == pytest.approx(frequency[0], rel=0.1)
    omega = 2 * np.pi * frequency
    poles = -LOSS * omega[0] + 1j * omega
    lines = 1j * (omega[0] + np.linspace(-1e5, 1e5, 400_001))
    one, other = 1 / (lines - poles[0]), 1 / (lines - poles[1])
    constants = np.stack([own.constants[:, NEIGHBOUR], lost.constants[:, 0]])
    both = np.stack([one, other], axis=1) @ constants
    fitted = np.linalg.lstsq(one[:, None], both, rcond=None)[0][0].real
    columns = change(without)[:, NEIGHBOUR]
    nearest = int(np.argmax(np.abs(columns).max(axis=0)))
    assert columns[:, nearest] == pytest.approx(fitted - constants[0], rel=0.02)


@pytest.mark.long
def test_a_test_that_misses_no_close_mode_stays_as_sharp_as_it_is(without: Setting) -> None:
    whole = setting(list(range(6)))
    size = np.abs(whole.nominal.constants).max()
    assert np.abs(change(whole)[:, :4]).max(initial=0.0) < 0.01 * size
    assert np.abs(change(without)).max() > 0.05 * size


@pytest.mark.parametrize("turned", [0, NEIGHBOUR])
def test_a_shape_that_is_turned_round_changes_no_doubt(without: Setting, turned: int) -> None:
    now = without.nominal
    sign = np.where(np.arange(len(now.frequency)) == turned, -1.0, 1.0)
    level = np.ones_like(now.constants)
    # of bare shapes the test's sign is put into the level
    bare = replace(without, measured=replace(without.measured, hit=np.full(len(without.measured.seen), -1)))
    other = replace(now, constants=now.constants * sign)
    found = MissedModes(bare)
    assert found.columns(other, level * sign) == pytest.approx(found.columns(now, level))
