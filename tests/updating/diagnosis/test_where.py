"""Places come with their mirror images, points with their names, regions with a probability, modes with a weight."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from updating_cases import BEAM as FINE
from updating_cases import PLATE, POINTS, ExactBeam, blank, case_of, observed, specimen, struck

from updating import LIBRARY, Case, Measured, Predictor
from updating.diagnosis.answer.clusters import clusters
from updating.diagnosis.answer.contributions import contributions
from updating.diagnosis.answer.where import acting_together, locate
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.evidence import Explanation, explain
from updating.diagnosis.search.search import search
from updating.models.state import State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

BEAM = FINE.with_elements(20)
FREE = replace(BEAM, clamped=(), regions=())


def without_shapes(test: Measured) -> Measured:
    none, n = np.zeros(0, dtype=int), len(test.frequency)
    return replace(
        test,
        seen=none,
        hit=none,
        constants=np.zeros((0, n)),
        constants_sigma=np.zeros((0, n)),
        absolute=False,
        phase=None,
    )


@cache
def free_beam(*, shapes: bool) -> SpecimenProblem:
    """A free beam with a soft spot off the middle, with or without shapes."""
    rng = np.random.default_rng(4)
    points = np.linspace(0.0, 0.376, 5)
    beam = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness, clamped=False, soft=(0.11, 0.13, 0.6))
    frequency = beam.frequencies(5)
    shape = beam.shapes(frequency, points)
    omega = 2 * np.pi * frequency
    test = observed(frequency, 1 / omega + 5e-7 * omega, shape * shape[-1], points, rng)
    return pose(case_of(test if shapes else without_shapes(test), FREE))[0]


def explained(problem: SpecimenProblem, name: str) -> Explanation:
    """As the search does it: a first look, then a closer one at the best place alone."""
    candidate = Candidate((LIBRARY[name],))
    first = explain(problem, candidate)
    return explain(problem, candidate, starts=[first.best.coordinates])


@pytest.mark.long
def test_a_free_beam_has_its_soft_spot_on_either_side_if_only_frequencies_are_known() -> None:
    problem = free_beam(shapes=False)
    found = clusters(problem, explained(problem, "local_stiffness"), "stiffness")
    places = sorted(c.place[0] for c in found[:2])
    assert places == pytest.approx([0.12, 0.376 - 0.12], abs=0.05 * 0.376)
    assert found[0].weight == pytest.approx(found[1].weight, rel=0.35)
    assert sum(c.weight for c in found) == pytest.approx(1.0, abs=0.1)


@pytest.mark.long
def test_shapes_tell_the_sides_apart() -> None:
    problem = free_beam(shapes=True)
    found = clusters(problem, explained(problem, "local_stiffness"), "stiffness")
    assert len(found) == 1
    assert found[0].place[0] == pytest.approx(0.12, abs=0.01)
    assert found[0].weight == pytest.approx(1.0)


@pytest.mark.long
def test_a_plate_hit_along_its_middle_does_not_know_its_left_from_its_right() -> None:
    points = np.stack([np.linspace(0.0752, 0.376, 5), np.full(5, 0.1)], axis=1)
    predictor = Predictor(PLATE, blank(points, top=300.0))
    soft = LIBRARY["local_stiffness"].state(predictor, {"x": 0.1, "y": 0.05, "extent": 0.05, "loss": 0.8})
    found = predictor.predict(soft, count=9)
    middle = np.abs(found.constants).max(axis=0) > 0.02 * np.abs(found.constants).max()
    test = observed(
        found.frequency[middle],
        found.damping[middle],
        found.constants[:, middle],
        points,
        np.random.default_rng(2),
    )
    problem = pose(case_of(test, PLATE))[0]
    places = clusters(problem, explained(problem, "local_stiffness"), "stiffness")
    left, right = (min(abs(c.place[1] - y) for c in places) for y in (0.05, 0.15))
    assert left < 0.02
    assert right < 0.02
    assert all(c.weight >= 0.05 for c in places)


@cache
def compared(truth: str) -> tuple[SpecimenProblem, Search]:
    rng = np.random.default_rng(11)
    beam = specimen(rng)
    library = ["E", "lumped_mass", "sensor_mass", "local_stiffness", "calibration_gain"]
    changes: dict[str, object] = {
        "soft": {"soft": (0.14, 0.16, 0.6)},
        "tip": {"masses": ((beam.length, 0.012),)},
        "unknown": {"soft": (0.0, 0.0376, 0.5)},
        "none": {},
        "both": {"soft": (0.14, 0.16, 0.6), "masses": ((0.3, 0.02),)},
    }
    test = struck(replace(beam, **changes.get(truth, {})), rng)  # type: ignore[arg-type]
    if truth == "unknown":
        library = ["calibration_gain"]
    if truth == "reversed":
        test = replace(test, constants=test.constants * np.array([1, 1, -1, 1, 1.0])[:, None])
        library = ["E", "polarity", "calibration_gain"]
    problem = pose(case_of(test, BEAM))[0]
    return problem, search(problem, [LIBRARY[n] for n in library])


@pytest.mark.long
def test_a_place_is_the_posterior_mean_with_its_spread() -> None:
    where = locate(*compared("soft"), verdict="named")
    assert where.location is not None
    assert where.location == where.locations[0] == where.likely_places[0].place
    assert where.location[0] == pytest.approx(0.15, abs=0.01)
    assert abs(where.location[0] - 0.15) < 4 * where.likely_places[0].spread[0] + 0.002
    assert where.points == (2,)  # at 0.1504 m
    assert where.channel == "stiffness"
    assert where.zones_by == "explanations"
    assert sum(z.probability for z in where.zones) == pytest.approx(1.0)


@pytest.mark.long
def test_a_mass_on_the_sensor_is_at_its_node() -> None:
    where = locate(*compared("tip"), verdict="named")
    assert where.channel == "mass"
    assert where.points == (5,)
    assert max(where.zones, key=lambda z: z.probability).name == "zone10"


@pytest.mark.long
def test_two_causes_have_two_places() -> None:
    problem, found = compared("both")
    assert set(found.compared[0].names) == {"lumped_mass", "local_stiffness"}
    where = locate(problem, found, verdict="named")
    assert where.channel == "stiffness"
    assert sorted(round(place[0], 2) for place in where.locations) == [0.15, 0.3]
    assert set(where.points) >= {2}


def test_channels_that_act_as_halves_of_a_pair_come_together() -> None:
    halves = {"stiffness": 0.495, "mass": 0.505, "damping": 0.0, "measurement": 0.0}
    assert acting_together(halves) == ("stiffness", "mass")
    assert acting_together({**halves, "stiffness": 0.3}) == ("mass",)
    assert acting_together(dict.fromkeys(halves, 0.0) | {"measurement": 0.5, "damping": 0.5}) == (
        "damping",
        "measurement",
    )


def test_points_of_the_measurement_are_named() -> None:
    where = locate(*compared("reversed"), verdict="named")
    assert where.channel == "measurement"
    assert where.points == (3,)


@pytest.mark.long
def test_what_nothing_explains_is_still_put_into_a_region() -> None:
    problem, found = compared("unknown")
    where = locate(problem, found, verdict="unknown")
    assert where.zones_by == "regions"
    assert max(where.zones, key=lambda z: z.probability).name == "zone1"
    assert sum(z.probability for z in where.zones) == pytest.approx(1.0)


@pytest.mark.long
def test_without_a_gap_there_is_no_place() -> None:
    where = locate(*compared("none"), verdict="none")
    assert (where.channel, where.location, where.locations, where.points) == ("none", None, (), ())
    assert "No mode stands out" in where.band


def test_the_modes_that_carry_the_gap_are_named() -> None:
    frequency = FINE.with_elements(20)
    predictor = Predictor(frequency, blank(POINTS))
    found = predictor.predict(State(), count=5)
    off = np.array([1, 1, 1.05, 1.06, 1])
    test = observed(found.frequency * off, found.damping, found.constants, POINTS, np.random.default_rng(1))
    seen = contributions(pose(case_of(test, BEAM))[0])
    assert "frequency of modes 3 to 4" in seen.summary
    assert seen.modes["share [%]"].sum() == pytest.approx(100)
    assert seen.modes.loc[[3, 4], "share [%]"].sum() > 80
    assert (seen.modes.loc[[3, 4], "frequency [sigma]"] > 3).all()
    assert (seen.modes["frequency [sigma]"].drop([3, 4]).abs() < 3).all()


@pytest.mark.long
def test_contributions_of_noise_alone_are_of_order_one() -> None:
    squares = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        table = contributions(pose(case_of(struck(specimen(rng), rng), BEAM))[0]).modes
        squares.append(table["frequency [sigma]"] ** 2)
    assert 0.4 < float(np.mean(squares)) < 1.6


def test_a_case_is_not_needed_twice() -> None:
    case: Case = case_of(compared("soft")[0].measured, BEAM)
    assert contributions(pose(case)[0]).summary == contributions(compared("soft")[0]).summary
