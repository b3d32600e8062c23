"""Five lines for every verdict: what, where, how far, how sure, what next."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from modalkit.letter import letter
from updating import LIBRARY, Diagnosis
from updating.diagnosis.result import Closed, Gap, NextTest, ParameterEstimate, Ranked, Shrink, Where

HEADS = ["Cause:", "Where:", "Closes:", "Sure:", "Next:"]
MASS = ParameterEstimate(0.0123, "kg", 0.0119, 0.0127, False)
SENSOR = Ranked(("sensor_mass",), 0.97, (), {"sensor_mass.mass": MASS}, True, 0.4)
E = Ranked(("E",), 0.02, (), {"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)}, True, 0.001)
TIP = Where("mass", {"mass": 0.97, "stiffness": 0.03}, (0.376, 0.0, 0.0), ((0.376, 0.0, 0.0),), (5,), ())
NAMED = Diagnosis(
    "beam",
    True,
    1e-12,
    Gap(pd.DataFrame(), 5.0, 0.05, np.zeros(0)),
    TIP,
    Shrink("frequency", 5.0, 0.1, 5.0, 0.2, 1.5, 4.0, 0.05, Closed(99.0, 97.0, 99.8)),
    "named",
    (("sensor_mass",),),
    (SENSOR, E),
    (),
    (),
    {},
)
SPREAD = Where("stiffness", {"stiffness": 0.6, "mass": 0.4}, None, (), (), ())
TESTS = (NextTest("weigh the specimen", ("E", "density"), 8.4), NextTest("calibrate", ("E", "density"), 3.0))
SPLIT = replace(
    NAMED,
    where=SPREAD,
    verdict="class",
    sets=(("E",), ("density", "length")),
    ranking=(replace(E, probability=0.6), Ranked(("density", "length"), 0.38, (), {}, True, 0.3)),
    next_test=TESTS,
)
UNKNOWN = replace(NAMED, verdict="unknown", sets=(), where=replace(TIP, points=()))
NONE = replace(
    NAMED,
    significant=False,
    p_value=0.4,
    verdict="none",
    sets=(),
    where=Where("none", {"none": 0.9, "mass": 1.0}, None, (), (), ()),
    shrink=replace(NAMED.shrink, closed=None, held_runner_up=None),
)


def lines(diagnosis: Diagnosis) -> dict[str, str]:
    found = letter(diagnosis)
    assert [line.split()[0] for line in found] == HEADS
    assert all("\n" not in line and len(line) > 15 for line in found)
    assert not any(word in " ".join(found) for word in ("nan", "None", "inf "))
    return {line.split(":")[0]: line for line in found}


@pytest.mark.parametrize("diagnosis", [NAMED, SPLIT, UNKNOWN, NONE])
def test_five_lines_for_every_verdict(diagnosis: Diagnosis) -> None:
    lines(diagnosis)
    lines(replace(diagnosis, ranking=()) if diagnosis.verdict in ("unknown", "none") else diagnosis)


def test_a_named_cause_says_its_size_its_place_and_its_test() -> None:
    said = lines(NAMED)
    assert "sensor_mass" in said["Cause"]
    assert "mass 0.0123 kg [0.0119, 0.0127]" in said["Cause"]
    assert LIBRARY["sensor_mass"].summary in said["Cause"]
    assert "mass (97 %), at x = 0.376 m (nearest test point 5)" in said["Where"]
    assert "5 % -> 0.1 % fitted, 0.2 % on modes held out (noise floor 0.05 %)" in said["Closes"]
    assert "runner-up 1.5 %" in said["Closes"]
    assert "tolerances alone 4 %" in said["Closes"]
    assert "closes 99 % [97, 100] of what can be closed" in said["Closes"]
    assert "97.0 %" in said["Sure"]
    assert "next E 2 %" in said["Sure"]
    assert "p = 1e-12" in said["Sure"]
    assert LIBRARY["sensor_mass"].separated_by in said["Next"]


def test_a_pair_is_named_with_both() -> None:
    both = Ranked(("E", "sensor_mass"), 0.99, (), {**E.parameters, **SENSOR.parameters}, True, 0.5)
    said = lines(replace(NAMED, sets=(both.effects,), ranking=(both,)))
    assert said["Cause"].startswith("Cause:   E + sensor_mass.")
    assert "factor 0.9 [0.89, 0.91]; mass 0.0123 kg" in said["Cause"]


def test_an_effect_without_parameters_and_one_from_outside() -> None:
    shear = Ranked(("shear",), 0.99, (), {}, True, 0.5)
    assert "()" not in lines(replace(NAMED, sets=(("shear",),), ranking=(shear,)))["Cause"]
    strange = Ranked(("gremlin",), 0.99, (), {}, True, 0.5)
    assert "gremlin" in lines(replace(NAMED, sets=(("gremlin",),), ranking=(strange,)))["Cause"]


def test_a_class_lists_all_of_it_and_the_test_that_splits_it() -> None:
    said = lines(SPLIT)
    assert "cannot tell apart: E, density + length" in said["Cause"]
    assert "spread over the whole structure" in said["Where"]
    assert "98.0 %" in said["Sure"]
    assert "weigh the specimen: separates E from density by 8 sigma" in said["Next"]
    without = lines(replace(SPLIT, next_test=()))["Next"]
    assert LIBRARY["density"].separated_by in without
    assert LIBRARY["length"].separated_by in without


def test_a_test_that_separates_pairs_reads_as_such() -> None:
    """Three names of two sets are not three things to tell from one another."""
    three = (NextTest("weigh the specimen", ("E", "density", "length"), 8.4),)
    assert "by 8 sigma" in lines(replace(SPLIT, next_test=three))["Next"]


def test_the_unknown_is_not_dressed_up() -> None:
    said = lines(UNKNOWN)
    assert "unknown" in said["Cause"]
    assert "do not trust it" in said["Where"]
    assert "0.376" not in said["Where"]
    assert "97" not in said["Sure"]
    assert "modes that miss most" in said["Next"]


def test_no_gap_needs_nothing() -> None:
    said = lines(NONE)
    assert "no gap" in said["Cause"]
    assert "nowhere" in said["Where"]
    assert "nothing to close" in said["Closes"]
    assert "p = 0.4" in said["Sure"]
    assert "within its tolerances" in said["Next"]


def test_a_gap_too_small_to_close_says_no_share() -> None:
    small = replace(NAMED, shrink=replace(NAMED.shrink, closed=None, held_runner_up=None))
    said = lines(small)["Closes"]
    assert "of what can be closed" not in said
    assert "runner-up" not in said


def test_a_fault_of_the_measurement_has_no_place_on_the_structure() -> None:
    chain = Where("measurement", {"measurement": 1.0}, None, (), (), ())
    assert lines(replace(NAMED, where=chain))["Where"] == "Where:   measurement (100 %)"


def test_a_place_on_a_plate_has_two_coordinates_and_its_mirror_images() -> None:
    corner = (0.3, 0.15, 0.0)
    found = replace(TIP, location=corner, locations=(corner,), points=(7, 9))
    said = lines(replace(NAMED, where=found))["Where"]
    assert said.endswith("at x = 0.300 m, y = 0.150 m (nearest test point 7, 9)")
    both = replace(TIP, location=corner, locations=(corner, (0.3, 0.05, 0.0)), points=())
    said = lines(replace(NAMED, where=both))["Where"]
    assert said.endswith("at x = 0.300 m, y = 0.150 m and x = 0.300 m, y = 0.050 m")
