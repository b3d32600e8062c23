"""Effects with values that a modeller states: which are taken, which refused, what they weigh."""

import re
from dataclasses import replace

import numpy as np
import pytest
from effect_cases import (
    LOOK,
    THIN,
)
from updating_cases import BEAM, POINTS, blank

from acquisition.errors import StudyError
from updating import LIBRARY, Environment, Predictor
from updating.effects import accepted_state
from updating.models import PointMass


def test_a_fluid_that_is_stated_is_not_searched_for() -> None:
    stated = replace(LOOK["beam"], environment=Environment(998.0, free_surface=0.2, bottom=0.1))
    parameter, wall = LIBRARY["fluid_added_mass"].parameters(stated)
    assert wall.name == "wall"
    assert parameter.low == pytest.approx(0.97 * 998)
    assert parameter.high == pytest.approx(1.03 * 998)


def test_a_mass_of_nothing_says_where_a_sensor_sits() -> None:
    spec = replace(THIN, masses=(PointMass((0.376,), 0.0),))
    predictor = Predictor(spec, blank(POINTS[:0], shapes_only=True))
    assert LIBRARY["sensor_mass"].obstacle(predictor) is None
    assert LIBRARY["sensor_mass"].locations(predictor, {"mass": 0.01}) == ((0.376, 0.0, 0.0),)


@pytest.mark.parametrize("values", [{}, {"stifness": 4000.0}, {"stiffness": 4000.0, "loss": 0.1}])
def test_an_accepted_effect_takes_its_own_parameters_only(values: dict[str, float]) -> None:
    predictor = Predictor(BEAM, blank(POINTS))
    with pytest.raises(StudyError, match="stiffness"):
        accepted_state(predictor, "clamp_rotation", values)


def test_an_accepted_effect_must_exist() -> None:
    with pytest.raises(StudyError, match="moon_phase"):
        accepted_state(Predictor(BEAM, blank(POINTS)), "moon_phase", {})


@pytest.mark.parametrize(
    ("name", "values", "says"),
    [
        ("lumped_mass", {"mass": 0.01, "x": 99.0}, "x = 99 m is off the structure"),
        ("lumped_mass", {"mass": -0.01, "x": 0.1}, "mass = -0.01 kg must be positive"),
        ("lumped_mass", {"mass": 1e300, "x": 0.1}, "million times outside"),
        ("sensor_mass", {"mass": 0.01, "bulk": -1.0}, "bulk = -1 must not be negative"),
        ("local_stiffness", {"x": 0.1, "extent": 0.02, "loss": 1.0}, "removes all stiffness"),
        ("local_stiffness", {"x": 0.1, "extent": 0.02, "loss": -1e300}, "million times outside"),
        ("clamp_rotation", {"stiffness": -1.0}, "stiffness = -1 N m/rad must be positive"),
        ("E", {"factor": 0.0}, "factor = 0 must be positive"),
        ("length", {"extension": -0.376}, "leaves nothing of the structure"),
    ],
)
def test_values_that_nothing_has_are_refused(name: str, values: dict[str, float], says: str) -> None:
    with pytest.raises(StudyError, match=re.escape(says)):
        accepted_state(LOOK["beam"], name, values)


@pytest.mark.parametrize("place", ["beam", "plate"])
@pytest.mark.parametrize("name", ["lumped_mass", "damping_patch"])
def test_a_balance_shows_the_mass_that_an_effect_adds_to_a_body_moving_as_one(name: str, place: str) -> None:
    free = LOOK[place].of(replace(LOOK[place].spec, clamped=()))
    values = {
        "x": 0.2,
        "y": 0.1,
        "extent": 0.1,
        "mass": 0.1,
        "bulk": 0.0,
        "stiffness": 0.0,
        "loss_factor": 0.1,
    }
    moving = free.reduced.sampled["w"]
    unit = np.linalg.lstsq(moving, np.ones(len(moving)), rcond=None)[0]
    added = sum(LIBRARY[name].state(free, values).mass)
    assert LIBRARY[name].weight(free, values) == pytest.approx(unit @ added @ unit, rel=1e-6)
    assert LIBRARY[name].weight(free, values) > 0
