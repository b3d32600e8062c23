"""Close modes that dampers at some places turn into each other, beside the poles of the state space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, blank

from updating import LIBRARY, Predictor
from updating.models.state import State

SQUARE = replace(
    PLATE, width=0.97 * PLATE.length, clamped=(), damping=replace(PLATE.damping, alpha=0.2, beta=1e-7)
)
GRID = np.stack(np.meshgrid(np.linspace(0, SQUARE.length, 5), np.linspace(0, SQUARE.width, 5)), -1).reshape(
    -1, 2
)
LOOK = Predictor(SQUARE, blank(GRID, sensor=3))
COUNT = 5


def cords(damping: float) -> State:
    """Two damped cords across a diagonal."""
    values = {"stiffness": 2e3, "inset": 0.05, "cords": 2.0, "damping": damping}
    return LIBRARY["suspension"].state(LOOK, values)


def exact(state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies [Hz], damping ratios and complex modal constants (n_frf, n_modes) [1/kg]."""
    found = LOOK.complex_modes(state)
    lowest = np.argsort(np.abs(found.poles))[:COUNT]
    poles, vectors = found.poles[lowest], found.vectors[:, lowest]
    seen, hit = LOOK.frf_rows(state)
    residues = (seen @ vectors) * (hit @ vectors)
    return np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles), 2j * poles.imag * residues


@pytest.mark.parametrize("damping", [0.0, 2.0, 8.0])
def test_poles_and_constants_are_those_of_the_state_space(damping: float) -> None:
    found = LOOK.predict(cords(damping), count=COUNT)
    frequency, ratio, constants = exact(cords(damping))
    assert found.frequency == pytest.approx(frequency, rel=1e-4)
    assert found.damping == pytest.approx(ratio, rel=0.05, abs=1e-5)
    direction = np.angle(np.sum(constants**2, axis=0)) / 2
    exactly_real = np.real(constants * np.exp(-1j * direction))
    turned = np.zeros(COUNT) if found.phase is None else found.phase[0]
    alike = np.sum(found.constants * exactly_real, axis=0) / np.sum(exactly_real**2, axis=0)
    left = found.constants - exactly_real * np.sign(alike)
    assert np.abs(np.exp(2j * (turned - direction)) - 1).max() < 0.1
    assert np.sqrt(np.sum(left**2, axis=0) / np.sum(exactly_real**2, axis=0)).max() < 0.12


def test_without_the_dampers_these_shapes_are_others() -> None:
    """What the test above would let pass, if modes were only slowed and damped."""
    still = LOOK.predict(cords(0.0), count=COUNT).constants
    damped = LOOK.predict(cords(8.0), count=COUNT).constants
    alike = np.sum(still * damped, axis=0) ** 2 / (np.sum(still**2, axis=0) * np.sum(damped**2, axis=0))
    assert alike.min() < 0.997
