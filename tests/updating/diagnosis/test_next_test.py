"""Hypothetical tests: what each separates, against what is known by hand, and in which order they are proposed."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import ModalData
from updating.case import Case
from updating.diagnosis.answer.rules import DEFAULT_RULES
from updating.diagnosis.answer.verdict import decide
from updating.diagnosis.diagnose import diagnose, diagnose_together, pose
from updating.diagnosis.next_test import _Found, propose
from updating.diagnosis.next_test.base import Rival, Site, separation
from updating.diagnosis.next_test.changed import AddedMass
from updating.diagnosis.next_test.free_free import FreeFree
from updating.diagnosis.next_test.instruments import Caliper, Weigh, WeighSensor
from updating.diagnosis.next_test.other_points import Shapes
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.search import search
from updating.effects import LIBRARY
from updating.models import Material, Spec
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem
from updating.test_data.axes import Axes
from updating.test_data.taken import measured_from_modes
from updating.tolerances import Tolerances

BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(20,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=Material(210e9, 7850.0, 0.3),
)
DOUBTS = Tolerances({"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002}, 0.3)
SCALED = ("E", "density", "thickness", "length")


def modes_of(factor: float, count: int = 4) -> ModalData:
    bare = ModalData(frequency=np.ones(1), frequency_sigma=np.ones(1))
    predictor = Predictor(BEAM, measured_from_modes(bare, Axes(), BEAM))
    frequency = predictor.predict(State(factors={"E": factor}), count=count).frequency
    return ModalData(frequency=frequency, frequency_sigma=5e-4 * frequency)


def case_of(factor: float = 0.85, title: str = "beam") -> Case:
    measured = measured_from_modes(modes_of(factor), Axes(), BEAM, repeatability=1e-3, title=title)
    return Case(title, BEAM, measured, tolerances=DOUBTS)


@pytest.fixture(scope="module")
def problem() -> SpecimenProblem:
    return pose(case_of())[0]


@pytest.fixture(scope="module")
def rivals(problem: SpecimenProblem) -> dict[str, Rival]:
    return {n: Rival(problem, explain(problem, Candidate((LIBRARY[n],)))) for n in SCALED}


def separation_of(trial: object, problem: SpecimenProblem, a: Rival, b: Rival) -> float:
    expected = trial.outcomes(Site(problem, 0), (a, b))
    return separation(expected[0], expected[1], b)


@pytest.mark.long
def test_weighing_sees_density_as_far_as_tolerances_and_balance_allow(
    problem: SpecimenProblem, rivals: dict[str, Rival]
) -> None:
    """Either explanation expects another mass; the rival's mass is as uncertain as its tolerances and the balance."""
    a, b = rivals["density"], rivals["E"]
    found = separation_of(Weigh(clamped=True), problem, a, b)
    heavier = np.log(1 / 0.85)
    doubt = np.sqrt(0.003**2 + 0.005**2 + 0.002**2 + Weigh.sigma**2)
    assert found == pytest.approx(heavier / doubt, rel=0.15)
    assert separation_of(Weigh(clamped=True), problem, rivals["length"], b) < 0.3 * found


def test_a_caliper_sees_the_thickness_and_nothing_of_density(
    problem: SpecimenProblem, rivals: dict[str, Rival]
) -> None:
    assert separation_of(Caliper(), problem, rivals["thickness"], rivals["E"]) > 10
    assert separation_of(Caliper(), problem, rivals["density"], rivals["E"]) < 0.3


def test_an_added_mass_tells_stiffness_from_mass(problem: SpecimenProblem, rivals: dict[str, Rival]) -> None:
    """A beam that is heavier feels an added mass less."""
    site = Site(problem, 0)
    light = AddedMass(site, np.array([0.4]), 0.002)
    heavy = AddedMass(site, np.array([0.4]), 0.05)
    assert separation_of(heavy, problem, rivals["E"], rivals["density"]) > 3
    assert separation_of(light, problem, rivals["E"], rivals["density"]) < separation_of(
        heavy, problem, rivals["E"], rivals["density"]
    )


def test_free_of_its_clamp_the_beam_shows_what_the_clamp_did(
    problem: SpecimenProblem, rivals: dict[str, Rival]
) -> None:
    assert separation_of(FreeFree(), problem, rivals["length"], rivals["E"]) > 5
    # stiffness and density make one and the same change of all frequencies, in a clamp or out of it
    assert separation_of(FreeFree(), problem, rivals["density"], rivals["E"]) < 0.5


def test_the_level_of_the_frfs_tells_density_from_stiffness(
    problem: SpecimenProblem, rivals: dict[str, Rival]
) -> None:
    assert separation_of(Shapes(Site(problem, 0)), problem, rivals["density"], rivals["E"]) > 3


def test_a_sensor_on_the_balance_says_nothing_where_no_sensor_is_blamed(
    problem: SpecimenProblem, rivals: dict[str, Rival]
) -> None:
    assert separation_of(WeighSensor(), problem, rivals["density"], rivals["E"]) == 0


def test_a_rival_is_never_separated_from_itself(problem: SpecimenProblem, rivals: dict[str, Rival]) -> None:
    site = Site(problem, 0)
    for trial in (Caliper(), Weigh(clamped=True), FreeFree(), Shapes(site)):
        assert separation_of(trial, problem, rivals["E"], rivals["E"]) < 1e-6


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_what_separates_all_comes_first_and_the_cheapest_of_it_at_the_top(problem: SpecimenProblem) -> None:
    found = search(problem, [LIBRARY[n] for n in SCALED])
    verdict, sets = decide(found, significant=True)
    assert verdict == "class"
    tests = propose(problem, found, sets, verdict)
    whole = [test.whole for test in tests]
    assert whole == sorted(whole, reverse=True)
    assert whole[0]
    assert all(test.expected_sigma >= 1 for test in tests)
    assert set(tests[0].separates) == {name for names in sets for name in names}


def test_two_explanations_are_told_apart_by_the_cheapest_way(problem: SpecimenProblem) -> None:
    found = search(problem, [LIBRARY[n] for n in ("E", "density")])
    tests = propose(problem, found, (("E",), ("density",)))
    assert "weigh" in tests[0].measure
    assert tests[0].separates == ("E", "density")


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_a_named_cause_is_separated_from_its_most_probable_rival_first(problem: SpecimenProblem) -> None:
    """Of E the length is the nearest rival here: what tells them apart stands before what tells others better."""
    found = search(problem, [LIBRARY[n] for n in SCALED])
    rivals = [
        row.names for row in found.compared if row.names and row.names != ("E",) and "E" not in row.names
    ]
    tests = propose(problem, found, (("E",),), "named")
    confirms = [
        (("E",), rivals[0]) in test.pairs and test.expected_sigma >= DEFAULT_RULES.separated_sigma
        for test in tests
    ]
    assert confirms == sorted(confirms, reverse=True)
    assert all(
        test.expected_sigma >= DEFAULT_RULES.separated_sigma or test.pairs == ((("E",), rivals[0]),)
        for test in tests
    )
    assert {("E",)} == {pair[0] for test in tests for pair in test.pairs}


def test_where_no_rival_is_separated_the_most_probable_one_is_spoken_of() -> None:
    """Not the one that a test comes nearest to separating."""
    sigmas = {(0, 1): 1.2, (0, 2): 2.9}
    trial, site = Caliper(), Site(pose(case_of())[0], 0)
    assert _Found(trial, site, sigmas).stated == ((0, 2),)
    assert _Found(trial, site, sigmas, (0, 1)).stated == ((0, 1),)
    assert not _Found(trial, site, {(0, 1): 1.2, (0, 2): 9.0}, (0, 1)).confirms


@pytest.mark.long
def test_several_specimens_say_on_which_of_them() -> None:
    cases = [case_of(0.85, "first"), case_of(0.8, "second")]
    both = diagnose_together(cases, library=[LIBRARY["E"], LIBRARY["density"]])
    assert both.verdict == "class"
    assert all(test.measure.startswith(("first: ", "second: ")) for test in both.next_test)
    assert both.next_test


def test_a_cause_that_is_named_gets_a_test_that_confirms_it() -> None:
    case = case_of()
    sure = replace(case, tolerances=replace(DOUBTS, factors={**DOUBTS.factors, "E": 0.01}))
    alone = diagnose(sure, library=[LIBRARY["E"], LIBRARY["clamp_rotation"]])
    if alone.verdict == "named":
        assert all("E" in test.separates for test in alone.next_test)
    else:
        assert alone.next_test


@pytest.mark.long
def test_the_unknown_gets_advice_and_no_figure() -> None:
    case = case_of()
    odd = case.measured.frequency * np.array([1.0, 1.3, 0.8, 1.2])
    wild = replace(case, measured=replace(case.measured, frequency=odd))
    answer = diagnose(wild, library=[LIBRARY["E"], LIBRARY["density"]])
    assert answer.verdict == "unknown"
    assert answer.next_test
    assert all(test.separates == () and np.isnan(test.expected_sigma) for test in answer.next_test)
    advice = " ".join(test.measure for test in answer.next_test)
    assert "in another state, as a baseline" in advice  # what holds for a building too
    assert "bare" not in advice and "dry" not in advice


def test_no_gap_needs_no_test() -> None:
    fine = diagnose(case_of(1.0), library=[LIBRARY["E"], LIBRARY["density"]])
    assert fine.verdict == "none"
    assert fine.next_test == ()
