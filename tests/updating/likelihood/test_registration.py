"""From which end places were measured: a body at an end is where the specimen ends, whatever its length."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, PLATE, blank, case_of, exactly

from updating import Predictor
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.goodness import p_values
from updating.diagnosis.search.points import evaluate
from updating.likelihood.registration import registration_doubt, with_registration
from updating.models.parts import PointMass
from updating.problem.candidate import Candidate

TOLERANCES = {"length": 0.002, "width": 0.004}
FREE = replace(BEAM, clamped=(), length=0.9, thickness=0.008, masses=(PointMass((0.0,), 0.02),))
PLACES = np.linspace(0.0, FREE.length, 9)


def test_a_single_clamp_states_the_end_and_two_or_none_do_not() -> None:
    assert registration_doubt(BEAM, TOLERANCES) == pytest.approx([0.0])
    for clamped in ((), ("x0", "x1")):
        spec = replace(BEAM, clamped=clamped)
        assert registration_doubt(spec, TOLERANCES) == pytest.approx([0.5 * 0.002 * BEAM.length])
    both = registration_doubt(PLATE, TOLERANCES)  # clamped at x0, free along y
    assert both == pytest.approx([0.0, 0.5 * 0.004 * PLATE.width])


def test_places_at_an_end_are_where_the_structure_ends() -> None:
    sigma = with_registration(np.full(3, 3e-4), np.array([0.0, 0.2, 0.5]), 0.5, 2e-4)
    assert sigma == pytest.approx([5e-4, 3e-4, 5e-4])


def test_a_specimen_longer_behind_its_sensor_stretches_no_doubt_of_the_sensors_place() -> None:
    """All places were measured from a line that lies inside of the end by two sigma of the length."""
    beyond = 2 * 0.002 * FREE.length
    true = replace(FREE, length=FREE.length + beyond, masses=(PointMass((beyond,), 0.02),))
    truth = Predictor(true, blank(PLACES + beyond, top=900.0, sensor=0)).predict(at_least=5)
    nominal = Predictor(FREE, blank(PLACES, top=900.0, sensor=0))
    test = exactly(nominal, truth, sigma=2e-4, repeatability=2e-4, position_sigma=5e-4)
    problem, _ = pose(case_of(test, FREE))
    point = evaluate(problem, Candidate(), np.zeros(0))
    place = problem.names.index("mass 1 x")
    assert problem.sigmas[place] > beyond / 3
    assert abs(point.marginal.shift[place]) < 3
    assert min(p_values(point).values()) > 0.01
