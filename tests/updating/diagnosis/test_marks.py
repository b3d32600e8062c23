"""An answer that has a point far from where it is stated says which, and by how much."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, ExactBeam, case_of, observed

from updating.diagnosis.diagnose import pose
from updating.diagnosis.notes import on_marks
from updating.diagnosis.search.evidence import explain
from updating.problem.candidate import Candidate

POINTS = np.array([0.08, 0.16, 0.23, 0.3, 0.376])
SENSOR = 1


def notes(off: float) -> list[str]:
    """The nominal beam, its sensor ``off`` [m] from the stated place."""
    rng = np.random.default_rng(7)
    beam = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness)
    frequency = beam.frequencies(5)
    omega = 2 * np.pi * frequency
    stood = POINTS.copy()
    stood[SENSOR] += off
    there = beam.shapes(frequency, np.concatenate([POINTS, stood]))
    shape, sensor = there[: len(POINTS)], there[len(POINTS) + SENSOR]
    test = observed(frequency, 1 / omega + 5e-7 * omega, shape * sensor, POINTS, rng, sensor=SENSOR)
    problem = pose(case_of(replace(test, position_sigma=0.001), BEAM.with_elements(20)))[0]
    return on_marks(problem, explain(problem, Candidate()).best, "no cause")


@pytest.mark.parametrize("off", [-0.008, 0.008])
def test_a_sensor_that_stood_elsewhere_is_named_with_the_distance(off: float) -> None:
    (note,) = notes(off)
    assert f"the sensor of point {SENSOR + 1} " in note
    # the stated place draws it back by a millimetre and more
    assert 6.0 < float(re.search(r"([\d.]+) mm from", note)[1]) < 8.5


@pytest.mark.parametrize("off", [0.0, 0.001])
def test_within_its_doubt_none_is(off: float) -> None:
    assert notes(off) == []
