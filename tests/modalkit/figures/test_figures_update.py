"""Figures of an update."""

from __future__ import annotations

import numpy as np
import pytest
from figure_text import assert_legible, panels, words

from acquisition import InputError
from modalkit.figures import update_figure


@pytest.mark.parametrize("modes", [1, 12])
@pytest.mark.parametrize("parameters", [None, {"E": (0.93, 0.004), "zone10.thickness": (1.2, np.nan)}])
def test_update_shows_errors_and_factors(
    modes: int, parameters: dict[str, tuple[float, float]] | None
) -> None:
    frequency = np.linspace(20, 2000, modes)
    figure = update_figure(
        frequency, np.full(modes, 4.0), np.full(modes, -0.5), sigma=np.full(modes, 0.1), parameters=parameters
    )
    assert "from 4 % to 0.5 % r.m.s." in words(figure)
    assert any(name.startswith("Parameters") for name in panels(figure)) == (parameters is not None)
    assert_legible(figure)


def test_update_refuses_arrays_that_do_not_fit() -> None:
    with pytest.raises(InputError, match="one of each per mode"):
        update_figure(np.ones(3), np.ones(2), np.ones(3))
