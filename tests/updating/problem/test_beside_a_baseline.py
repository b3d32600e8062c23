"""A baseline corrects the model of any specimen to the same modes: tolerances alone move nothing beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly, specimen, struck

from updating import LIBRARY, Case, Measured, Predictor, Tolerances
from updating.diagnosis.answer.verdict import estimates
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.effects import accepted_state
from updating.models.state import NOMINAL, State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

SPECIMEN = {"E": 1.03, "thickness": 0.98}
THICKER = 1.15


def measured(factors: dict[str, float]) -> Measured:
    evaluation = Predictor(BEAM, blank(POINTS))
    return exactly(evaluation, evaluation.predict(State(factors=factors), count=4))


@pytest.fixture(scope="module")
def problem() -> SpecimenProblem:
    """A beam off by tolerances as wide as they come, and then thicker than it was."""
    changed = {**SPECIMEN, "thickness": SPECIMEN["thickness"] * THICKER}
    doubts = Tolerances({"E": 0.2, "thickness": 0.1, "length": 0.01})
    case = Case("a beam", BEAM, measured(changed), baseline=measured(SPECIMEN), tolerances=doubts)
    return pose(case)[0]


def test_a_shift_of_tolerances_is_not_counted_twice(problem: SpecimenProblem) -> None:
    assert not problem.wide
    as_it_is = problem.compare(NOMINAL)
    shifted = problem.compare(NOMINAL, np.ones(len(problem.names)))
    assert shifted.residual == pytest.approx(as_it_is.residual)
    assert problem.strain(np.ones(len(problem.names))) == 0.0


@pytest.mark.long
def test_what_has_changed_since_is_found_whatever_the_tolerances(problem: SpecimenProblem) -> None:
    found = explain(problem, Candidate((LIBRARY["thickness"],)))
    values = problem.values(found.candidate, found.best.coordinates)
    assert values["thickness.factor"] == pytest.approx(THICKER, rel=0.005)
    assert found.p_value > 0.05
    assert found.log_evidence > explain(problem, Candidate()).log_evidence + 10


HEAVIER = 2.3


@pytest.mark.long
@pytest.mark.parametrize(
    "missed",
    [{"masses": ((0.3008, 0.05),)}, {"soft": (0.10, 0.13, 0.6)}],
    ids=["a body on it", "a soft spot"],
)
def test_what_the_model_misses_matters_less_or_as_much_once_all_is_heavier(missed: dict[str, object]) -> None:
    """A body adds to each mode a share of its mass, which falls; a soft spot bends all the same."""
    rng = np.random.default_rng(5)
    before = struck(specimen(rng, **missed), rng)
    rng = np.random.default_rng(5)
    after = struck(specimen(rng, density=HEAVIER, **missed), rng)
    posed, _ = pose(case_of(after, baseline=before))
    found = explain(posed, Candidate((LIBRARY["density"],)))
    size = estimates(posed, found)["density.factor"]
    assert size.low95 is not None and size.high95 is not None
    assert size.low95 < HEAVIER < size.high95 < 1.1 * HEAVIER
    assert found.best.marginal.scale == 1
    assert found.p_value > 0.05


BODY = ("lumped_mass", {"mass": 0.05, "x": 0.3008, "bulk": 0.0})


def with_body(factors: dict[str, float]) -> Measured:
    """A test of the beam with a body on it."""
    name, values = BODY
    predictor = Predictor(BEAM, blank(POINTS), additions=(lambda own: accepted_state(own, name, values),))
    return exactly(predictor, predictor.predict(State(factors=factors), count=4))


@pytest.mark.parametrize("stiffer", [1.0, 1.06])
def test_what_was_there_before_is_in_the_model_of_the_baseline(stiffer: float) -> None:
    """The body shifts both tests alike, so it is no part of the gap, and its idealisation leaves no doubt."""
    after, before = with_body({"E": stiffer}), with_body({})
    case = replace(case_of(after, baseline=before), accepted=(BODY,))
    problem, warnings = pose(case)
    assert problem.nominal.frequency == pytest.approx(before.frequency, rel=1e-5)
    assert problem.before is not None
    shift, known = problem.before.frequency(problem.nominal)
    noise = (before.frequency_sigma / before.frequency) ** 2 + before.repeatability**2
    assert shift == pytest.approx(noise, rel=1e-3)
    assert known == pytest.approx(problem.nominal.log_frequency_by, abs=1e-6)
    assert any("lumped_mass" in warning and "before = false" in warning for warning in warnings)
    residual = problem.compare(NOMINAL).residual[:4]
    assert residual == pytest.approx(np.full(4, 0.5 * np.log(stiffer)), abs=1e-4)


@pytest.mark.parametrize("since", [(), (0,)], ids=["before", "after"])
def test_no_key_is_proposed_where_the_study_has_it(since: tuple[int, ...]) -> None:
    case = case_of(with_body({"E": 1.06}), baseline=with_body({}))
    _, warnings = pose(replace(case, accepted=(BODY,), since_baseline=since, baseline_stated=(0,)))
    (note,) = [warning for warning in warnings if "[[model.effect]]" in warning]
    assert note.endswith(", as the study states") and "write" not in note


def test_what_came_after_the_baseline_acts_on_the_corrected_model() -> None:
    after, before = with_body(SPECIMEN), measured(SPECIMEN)
    case = replace(case_of(after, baseline=before), accepted=(BODY,), since_baseline=(0,))
    problem, warnings = pose(case)
    assert problem.nominal.frequency == pytest.approx(after.frequency, rel=1e-3)
    assert any("lumped_mass" in warning and "before = true" in warning for warning in warnings)
