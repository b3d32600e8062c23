"""An exponential window left in: poles keep their ringing frequency and decay faster."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank

from updating import Predictor
from updating.models.state import State
from updating.prediction.window_left import window_turns, with_window


@given(hertz=st.floats(1.0, 5000.0), zeta=st.floats(0.0, 0.2), decay=st.floats(1e-3, 50.0))
def test_the_pole_is_moved_by_the_decay(hertz: float, zeta: float, decay: float) -> None:
    omega = 2 * np.pi * hertz
    pole = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2) - decay
    frequency, damping = with_window(np.array([hertz]), np.array([zeta]), decay)
    assert frequency[0] == pytest.approx(abs(pole) / (2 * np.pi), rel=1e-12)
    assert damping[0] == pytest.approx(-pole.real / abs(pole), rel=1e-9)


def test_damping_that_nobody_expects_stays_unknown() -> None:
    frequency, damping = with_window(np.array([30.0]), np.array([np.nan]), 5.0)
    assert np.isnan(damping[0])
    assert frequency[0] > 30.0


def test_a_prediction_has_the_window_in_frequency_and_damping() -> None:
    predictor = Predictor(BEAM, blank(POINTS))
    plain, left = predictor.predict(count=4), predictor.predict(State(decay=8.0), count=4)
    frequency, damping = with_window(plain.frequency, plain.damping, 8.0)
    assert left.frequency == pytest.approx(frequency, rel=1e-12)
    assert left.damping == pytest.approx(damping, rel=1e-9)
    assert left.constants == pytest.approx(plain.constants)


def test_constants_turn_by_what_was_recorded() -> None:
    hertz = np.array([20.0, 200.0])
    assert window_turns(hertz, 5.0, 0) == pytest.approx(0.0)
    assert window_turns(hertz, 5.0, 2) == pytest.approx(2 * window_turns(hertz, 5.0, 1))
    assert window_turns(hertz, 5.0, 2)[0] == pytest.approx(-2 * np.arctan(5.0 / (40 * np.pi)))
    assert replace(blank(POINTS), recorded_power=2).recorded_power == 2
