"""A plate on its clamped columns alone: the same states, and no released clamp."""

from __future__ import annotations

import numpy as np
import pytest
from updating_cases import BEAM, PLATE, POINTS, blank

from updating import LIBRARY, Predictor
from updating.models.state import State
from updating.problem.candidate import Candidate

PLACES = np.array([[0.1, 0.03], [0.2, 0.15], [0.37, 0.1], [0.3, 0.19]])
KEEPING = {
    "lumped_mass": {"mass": 0.02, "x": 0.21, "y": 0.07, "bulk": 1.0},
    "local_mass": {"x": 0.2, "y": 0.1, "extent": 0.08, "extent_y": 0.06, "factor": 1.4},
    "local_stiffness": {"x": 0.1, "y": 0.1, "extent": 0.08, "extent_y": 0.06, "loss": 0.6},
    "ground_spring": {"x": 0.3, "y": 0.05, "stiffness": 1e5},
}


@pytest.fixture(scope="module")
def plate() -> Predictor:
    return Predictor(PLATE, blank(PLACES))


@pytest.mark.parametrize("name", sorted(KEEPING))
def test_what_keeps_the_clamps_is_the_same_on_fewer_columns(plate: Predictor, name: str) -> None:
    effect, values = LIBRARY[name], KEEPING[name]
    n = plate.reduced.ranks[frozenset()]
    whole, small = effect.state(plate, values), effect.state(plate.clamped, values)
    assert plate.clamped.reduced.basis.shape[1] == n < plate.reduced.basis.shape[1]
    for of in (plate, plate.clamped):  # either state is one of either model
        for expected, found in zip(of.reduced.matrices(whole), of.reduced.matrices(small), strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_candidate_is_on_fewer_columns_unless_an_effect_of_it_releases_a_clamp(plate: Predictor) -> None:
    mass, clamp = LIBRARY["lumped_mass"], LIBRARY["clamp_rotation"]
    assert Candidate((mass,)).stage(plate) is plate.clamped
    assert plate.clamped.clamped is plate.clamped
    assert Candidate((mass, clamp)).stage(plate) is plate


def test_a_beam_and_a_plate_whose_clamp_is_released_keep_all_columns() -> None:
    beam = Predictor(BEAM, blank(POINTS))
    assert beam.clamped is beam
    loose = Predictor(PLATE, blank(PLACES), additions=(lambda _: State(released=frozenset({"rotation"})),))
    assert loose.clamped is loose
