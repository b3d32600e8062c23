"""Noise that fades along the records speaks for a window, by no more than noise that fades for other reasons allows."""

from __future__ import annotations

import numpy as np
import pytest
from test_likelihood import perfect, problem, view

from identification.fading import Fading
from updating.likelihood.fading_noise import FadingNoise
from updating.models.state import NOMINAL, State

STEADY = Fading(0.0, 5000, 2.0, 0.0)


def residual(fading: Fading, decay: float) -> float:
    posed = problem(perfect(fading=fading))
    noise = next(q for q in posed.quantities if isinstance(q, FadingNoise))
    return float(noise.block(view(posed, State(decay=decay) if decay else NOMINAL)).residual[0])


def test_it_is_near_nothing_where_the_window_is_what_fades() -> None:
    faded = Fading(STEADY.expected(2.0), 5000, 2.0, 0.0)
    assert residual(faded, 2.0) == pytest.approx(0.0, abs=1e-9)
    assert residual(STEADY, 0.0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(("fading", "decay"), [(Fading(1.0, 5000, 2.0, 0.0), 0.0), (STEADY, 3.0)])
def test_it_speaks_against_a_state_by_no_more_than_a_factor_of_a_hundred(
    fading: Fading, decay: float
) -> None:
    assert 0.5 * residual(fading, decay) ** 2 == pytest.approx(np.log(100.0), rel=1e-3)
    assert np.sign(residual(fading, decay)) == (1 if decay == 0.0 else -1)


def test_a_test_without_hits_says_nothing_of_it() -> None:
    posed = problem(perfect(fading=None))
    assert not any(isinstance(q, FadingNoise) for q in posed.quantities)
