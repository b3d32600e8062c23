"""Modes turn into each other by what an effect's idealisation leaves in doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh
from updating_cases import PLATE, blank, exactly

from acquisition.arrays import FloatArray
from updating import Case, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Doubt, Setting, View
from updating.likelihood.close_modes import CloseModes
from updating.models.state import State

POINTS = np.array([(x, y) for x in np.linspace(0.1, 0.376, 4) for y in (0.0, 0.07, 0.2)])
SHIFT, FIDELITY, COUNT = 0.2, 0.01, 6


def setting() -> Setting:
    plate = replace(PLATE, elements=(12, 8))
    predictor = Predictor(plate, blank(POINTS))
    measured = exactly(predictor, predictor.predict(count=COUNT), sigma=1e-6, repeatability=1e-4)
    return pose(Case("a plate", plate, measured, tolerances=Tolerances({"E": 0.01})))[0].setting


def turned(setting: Setting, shift: FloatArray, gain: float = 1.0) -> FloatArray:
    """Return the columns (n_frf, n_modes, k) where an effect has shifted ln f by ``shift``."""
    now = setting.nominal
    close = CloseModes(
        replace(setting, nominal=replace(now, frequency=now.frequency * np.exp(-shift))), np.zeros(COUNT)
    )
    level = np.full_like(now.constants, gain)
    view = View(now, State(), Doubt(FIDELITY, uneven=FIDELITY))
    return close.turned_by_doubt(view, level).reshape(*now.constants.shape, -1)


def test_the_nearest_modes_turn_as_those_of_matrices_with_an_error_between_them() -> None:
    """Against a solved eigenproblem whose stiffness matrix errs between the two by one standard deviation."""
    posed = setting()
    now = posed.nominal
    close = int(np.argmin(np.diff(now.frequency)))
    pair = [close, close + 1]
    stiffness = np.diag(now.frequency**2)
    stiffness[pair, pair[::-1]] = 2 * FIDELITY * SHIFT * np.prod(now.frequency[pair])
    _, mixed = eigh(stiffness)
    mixed = mixed / np.diag(mixed) - np.eye(COUNT)  # the turn alone: levels are another doubt
    moved = now.gain * (now.seen @ mixed * now.hit + now.seen * (now.hit @ mixed))
    expected = np.sqrt(np.mean(moved[:, pair] ** 2, axis=0))
    found = np.sqrt(np.mean(turned(posed, np.full(COUNT, SHIFT))[:, pair, close] ** 2, axis=0))
    np.testing.assert_allclose(found, expected, rtol=0.1)


def test_a_mode_that_an_effect_leaves_alone_turns_into_none() -> None:
    """A mass at a node has no element between that mode and another one."""
    shift = np.full(COUNT, SHIFT)
    shift[2] = 0.0
    assert not turned(setting(), shift)[:, 2].any()


def test_columns_have_the_level_of_the_constants() -> None:
    posed, shift = setting(), np.full(COUNT, SHIFT)
    np.testing.assert_allclose(turned(posed, shift, gain=0.1), 0.1 * turned(posed, shift))
