"""An effect of the library is known wherever effects stand by their names outside of it."""

from __future__ import annotations

import pytest

from modalkit.blind.scoring.places import channels_of
from modalkit.planning.effects import NOT_FORECAST
from modalkit.planning.own.overall import OVERALL
from modalkit.planning.own.parts import PARTS
from modalkit.planning.own.spots import SPOTS
from modalkit.simulator.hidden import BLOCK_EFFECTS, FRAME_EFFECTS, HIDDEN_EFFECTS
from updating import LIBRARY

every = pytest.mark.parametrize("name", list(LIBRARY))


@every
def test_the_rig_hides_it(name: str) -> None:
    assert name in {**HIDDEN_EFFECTS, **FRAME_EFFECTS, **BLOCK_EFFECTS}


@every
def test_the_score_knows_its_channel(name: str) -> None:
    assert LIBRARY[name].channel in channels_of(name)


@every
def test_the_forecast_asks_about_it_or_says_why_not(name: str) -> None:
    assert name in {**SPOTS, **PARTS, **OVERALL, **NOT_FORECAST}
