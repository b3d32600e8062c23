"""A true cause beside one datum that is worse than stated, and one cause that acts at two places."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from modalkit.output.documents import diagnosis_document
from modalkit.output.summary import summary_text
from updating import LIBRARY, Diagnosis, diagnose
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.odd import with_odd_data
from updating.nominal import predictor_of
from updating.problem.candidate import Candidate

pytestmark = pytest.mark.long

BEAM = FINE.with_elements(20)
SOME = tuple(
    LIBRARY[name] for name in ("E", "density", "length", "sensor_mass", "clamp_rotation", "calibration_gain")
)


@cache
def answer(seed: int, what: str) -> Diagnosis:
    """A beam 10 % softer, of which one frequency, one damping or one point's constants were read wrong."""
    rng = np.random.default_rng(seed)
    beam = specimen(rng)
    test = struck(replace(beam, E=0.9 * beam.E) if what != "one shape" else beam, rng)
    first, third = np.arange(len(test.frequency)) == 0, np.arange(len(test.frequency)) == 2
    if what == "one frequency":
        test = replace(test, frequency=test.frequency * np.where(third, 1.02, 1.0))
    elif what == "one damping":
        test = replace(test, damping=test.damping * np.where(first, 10.0, 1.0))
    elif what == "one point":
        wrong = np.where(test.hit == 2, 0.8, 1.0)[:, None]
        test = replace(test, constants=test.constants * wrong)
    else:
        scattered = 1 + 0.4 * rng.standard_normal(len(test.hit))[:, None] * third
        test = replace(test, constants=test.constants * scattered)
    return diagnose(case_of(test, BEAM), library=SOME)


@pytest.mark.parametrize("what", ["one frequency", "one damping", "one point"])
@pytest.mark.parametrize("seed", [3, 17])
def test_one_bad_group_of_data_hides_no_cause(seed: int, what: str) -> None:
    found = answer(seed, what)
    assert ("E",) in found.sets
    # five frequencies tell little between the two, and one odd point may be of a cause in no library
    assert all({"E", "density", "something_else"} & set(names) for names in found.sets)
    assert found.ranking[0].effects in (("E",), ("density",))
    left = found.remainder
    assert left is not None
    assert left.significant
    wanted = {
        "one frequency": "mode 3 frequency",
        "one damping": "mode 1 damping",
        "one point": "point 3 in all modes",
    }
    assert wanted[what] in left.carried_by
    estimate = next(row for row in found.ranking if row.effects == ("E",)).parameters["E.factor"]
    assert estimate.low95 is not None
    assert estimate.high95 is not None
    assert estimate.low95 < 0.95
    assert estimate.high95 > 0.85


@pytest.mark.parametrize("seed", [3, 17])
def test_one_odd_shape_is_no_gap_and_is_the_remainder(seed: int) -> None:
    found = answer(seed, "one shape")
    assert "mode 3 shape" in summary_text(found)[0]
    assert found.verdict == "none"
    assert found.remainder is not None
    assert "mode 3 shape" in found.remainder.carried_by


MASSES = ((0.12, 0.02), (0.30, 0.03))


@cache
def two_bodies() -> Diagnosis:
    rng = np.random.default_rng(5)
    test = struck(replace(specimen(rng), masses=MASSES), rng)
    library = [LIBRARY[name] for name in ("E", "density", "lumped_mass", "sensor_mass", "local_stiffness")]
    return diagnose(case_of(test, BEAM), library=library)


def test_two_bodies_are_two_of_one_cause() -> None:
    found = two_bodies()
    assert found.ranking[0].effects == ("lumped_mass", "lumped_mass")
    assert ("lumped_mass", "lumped_mass") in found.sets
    row = found.ranking[0].parameters
    places = sorted(
        (row[f"{key}.x"].value, row[f"{key}.mass"].value) for key in ("lumped_mass", "lumped_mass#2")
    )
    for (x, mass), (true_x, true_mass) in zip(places, MASSES, strict=True):
        assert x == pytest.approx(true_x, abs=0.02)
        assert mass == pytest.approx(true_mass, rel=0.15)


def test_what_occurs_twice_stands_twice_and_is_included_once() -> None:
    found = two_bodies()
    document = diagnosis_document(found)
    assert document["cause"]["effects"].count("lumped_mass") == 2
    assert list(document["included"]).count("lumped_mass") == 1
    assert "lumped_mass#2.mass" in document["cause"]["ranking"][0]["parameters"]


def test_values_of_two_of_one_cause_go_back_to_their_quantiles() -> None:
    body = LIBRARY["lumped_mass"]
    both = Candidate((body, body.again()))
    predictor = predictor_of(
        case_of(struck(specimen(np.random.default_rng(1)), np.random.default_rng(2)), BEAM)
    )
    quantiles = np.array([0.3, 0.2, 0.4, 0.6, 0.8, 0.5])
    values = both.values(predictor, quantiles.tolist())
    assert values["lumped_mass.x"] < values["lumped_mass#2.x"]
    assert both.coordinates(predictor, values) == pytest.approx(quantiles)


def test_no_cause_sets_a_shape_aside_that_nothing_alone_may_not() -> None:
    rng = np.random.default_rng(3)
    test = struck(specimen(rng), rng)
    third = np.arange(len(test.frequency)) == 2
    scattered = 1 + 0.4 * rng.standard_normal(len(test.hit))[:, None] * third
    problem, _ = pose(case_of(replace(test, constants=test.constants * scattered), BEAM))
    nothing = explain(problem, Candidate())
    cause = explain(problem, Candidate((LIBRARY["calibration_gain"],)))
    nothing.__dict__["p_value"] = 1.0  # as where it is one shape among hundreds of data that fit well
    weighed = {one.names: one for one in with_odd_data(problem, [nothing, cause])}
    assert set(weighed) == {(), ("calibration_gain",)}
    assert weighed[()].candidate.outliers == weighed[("calibration_gain",)].candidate.outliers
    assert weighed[()].log_evidence > nothing.log_evidence


@pytest.mark.parametrize("seed", [3, 17])
def test_data_that_are_worse_than_stated_are_an_explanation_of_their_own(seed: int) -> None:
    """One frequency of a beam that has nothing else: no cause explains it better than that it was read wrong."""
    rng = np.random.default_rng(seed)
    test = struck(specimen(rng), rng)
    third = np.arange(len(test.frequency)) == 2
    found = diagnose(
        case_of(replace(test, frequency=test.frequency * np.where(third, 1.03, 1.0)), BEAM), library=SOME
    )
    assert found.verdict in ("unknown", "none")
    assert found.set_aside is not None
    assert found.set_aside.data == ("mode 3 frequency",)
    assert found.set_aside.probability > 0.5
    assert found.set_aside.probability + sum(row.probability for row in found.ranking) <= 1 + 1e-9
    without = [row for row in found.ranking if row.set_aside]
    assert without
    assert diagnosis_document(found)["cause"]["set_aside"]["data"] == ["mode 3 frequency"]
