"""Two causes at once: a sensor upside down beside a body that was forgotten, and rivals of a pair."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from updating_cases import BEAM, DOUBTS, POINTS, blank, case_of, exactly, specimen, struck

from updating import LIBRARY, Case, Diagnosis, Measured, Predictor, Tolerances, diagnose
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.sets import _in_other_forms
from updating.diagnosis.search.together import join
from updating.problem.candidate import Candidate
from updating.thresholds import WELL_FITTED

pytestmark = pytest.mark.long

FREE = replace(BEAM, length=0.5, clamped=()).with_elements(20)
PLACES = np.linspace(0.0, 0.5, 7)
SENSORS = (0, 4)
BODY, AT = 0.03, 0.19
CLAMP = Candidate((LIBRARY["clamp_translation"],))


def two_sensors(*, upside_down: int | None, seed: int = 3) -> Measured:
    """A free beam with a body, hit at seven points, seen by two sensors of which one may be upside down."""
    rng = np.random.default_rng(seed)
    beam = specimen(rng)
    beam = replace(beam, length=FREE.length, clamped=False, masses=((AT, BODY),))
    frequency = beam.frequencies(5)
    shape = beam.shapes(frequency, PLACES)
    rows = [(seen, hit) for seen in SENSORS for hit in range(7)]
    exact = np.array([shape[s] * shape[h] * (-1.0 if s == upside_down else 1.0) for s, h in rows])
    sigma = 0.01 * np.sqrt(np.mean(exact**2, axis=0)) * np.ones_like(exact)
    return replace(
        blank(PLACES),
        frequency=frequency * (1 + 5e-4 * rng.standard_normal(5)),
        frequency_sigma=1e-4 * frequency,
        damping=np.full(5, 0.002),
        damping_sigma=np.full(5, 1e-4),
        seen=np.array([s for s, _ in rows]),
        hit=np.array([h for _, h in rows]),
        constants=exact + sigma * rng.standard_normal(exact.shape),
        constants_sigma=sigma,
    )


def some(*names: str) -> list:
    return [LIBRARY[n] for n in names]


@cache
def answer() -> Diagnosis:
    library = some("polarity", "lumped_mass", "local_stiffness", "E", "calibration_gain")
    return diagnose(case_of(two_sensors(upside_down=4), FREE), library=library)


def test_a_sensor_upside_down_hides_no_mode_and_no_other_cause() -> None:
    found = answer()
    assert len(found.gap.modes) == 5
    assert (found.verdict, {frozenset(s) for s in found.sets}) == (
        "named",
        {frozenset({"polarity", "lumped_mass"})},
    )
    row = found.ranking[0]
    assert row.p_value > 0.01
    assert row.parameters["lumped_mass.x"].value == pytest.approx(AT, abs=0.01)
    assert row.parameters["lumped_mass.mass"].value == pytest.approx(BODY, rel=0.05)


def tip_and_length() -> Case:
    rng = np.random.default_rng(11)
    beam = specimen(rng)
    longer = replace(beam, length=beam.length + 0.012, masses=((beam.length + 0.012, 0.012),))
    return case_of(struck(longer, rng), BEAM.with_elements(20))


def test_what_resembles_a_part_of_the_best_pair_is_weighed_in_its_place() -> None:
    """A body at the sensor is as good as the sensor, wherever a body alone would fit best."""
    library = some("length", "sensor_mass", "lumped_mass", "E", "density", "thickness", "clamp_rotation")
    found = diagnose(tip_and_length(), library=library)
    pairs = {frozenset(row.effects): row for row in found.ranking}
    assert set(found.ranking[0].effects) == {"length", "sensor_mass"}
    rival = pairs[frozenset({"length", "lumped_mass"})]
    assert found.ranking[0].effects in rival.equivalents


def test_few_pairs_of_many_modes_name_no_cause() -> None:
    """Most of a test's modes are strangers to the model: whatever the others fit, nothing is named."""
    test = two_sensors(upside_down=None)
    strange = np.linalg.svd(test.constants)[0][:, 5:8] * np.linalg.norm(test.constants[:, 2:], axis=0)
    constants = np.hstack([test.constants[:, :2], strange])
    case = case_of(replace(test, constants=constants, constants_sigma=test.constants_sigma), FREE)
    found = diagnose(case, library=some("lumped_mass", "calibration_gain"))
    assert len(found.gap.modes) == 2
    assert found.significant and found.verdict in ("unknown", "class")
    assert not found.comparable
    assert any("most measured modes have no partner" in w for w in found.warnings)


def test_what_may_be_there_again_stays_in_the_library_when_one_is_accepted() -> None:
    """Two bodies are there, one of them known: the other is found where it is, and both accepted leave nothing."""
    bodies = ((0.15, 0.02), (0.31, 0.03))
    test = struck(replace(specimen(rng := np.random.default_rng(5)), masses=bodies), rng)
    library = some("lumped_mass", "local_stiffness", "E", "density")
    known, other = (("lumped_mass", {"x": x, "mass": mass}) for x, mass in bodies)
    case = case_of(test, BEAM.with_elements(20))
    found = diagnose(replace(case, accepted=(known,)), library=library)
    assert (found.verdict, found.sets) == ("named", (("lumped_mass",),))
    assert found.ranking[0].parameters["lumped_mass.x"].value == pytest.approx(0.31, abs=0.01)
    assert found.ranking[0].parameters["lumped_mass.mass"].value == pytest.approx(0.03, rel=0.05)
    assert diagnose(replace(case, accepted=(known, other)), library=library).verdict == "none"
    modulus = diagnose(replace(case, accepted=(("E", {"factor": 0.9}),)), library=library)
    assert all("E" not in row.effects for row in modulus.ranking)


def test_that_one_cause_fits_hides_no_second_one() -> None:
    """How far the sketch of a fluid may be off lets it fit what a clamp that gives way has changed as well."""
    effects = some("fluid_added_mass", "clamp_translation")
    seen, rng = Predictor(BEAM.with_elements(20), blank(POINTS)), np.random.default_rng(4)
    both = Candidate(tuple(effects))
    true = {"fluid_added_mass.fluid_density": 998.0, "clamp_translation.stiffness": 1e7}
    now = seen.predict(both.state(seen, both.coordinates(seen, true)), count=5)
    sigma = 0.01 * np.sqrt(np.mean(now.constants**2, axis=0)) * np.ones_like(now.constants)
    test = replace(
        blank(POINTS),
        frequency=now.frequency * (1 + 2e-4 * rng.standard_normal(5)),
        frequency_sigma=1e-4 * now.frequency,
        damping=np.full(5, np.nan),
        damping_sigma=np.full(5, np.nan),
        constants=now.constants + sigma * rng.standard_normal(now.constants.shape),
        constants_sigma=sigma,
    )
    found = diagnose(case_of(test, BEAM.with_elements(20)), library=[*effects, *some("E", "density")])
    single = next(row for row in found.ranking if row.effects == ("fluid_added_mass",))
    assert single.p_value > WELL_FITTED
    assert (found.verdict, {frozenset(s) for s in found.sets}) == ("named", {frozenset(both.names)})


def test_which_law_a_damping_follows_shows_beside_a_clamp() -> None:
    """All damping is two and a half times what is expected, on a clamp that shifts."""
    short = replace(BEAM, length=0.3, regions=())
    model = Predictor(short, blank(np.linspace(0.05, 0.3, 6), top=2500.0))
    shifted = LIBRARY["clamp_translation"].state(model, {"stiffness": 4e6})
    damped = LIBRARY["uniform_damping"].state(model, {"alpha": 1.5 * 2.0, "beta": 1.5e-6, "loss_factor": 0.0})
    truth = model.predict(shifted.plus(damped), count=5)
    scatter = 1 + 0.05 * np.random.default_rng(2).standard_normal(5)
    test = exactly(model, truth, damping=scatter * truth.damping)
    problem, _ = pose(Case("a beam", short, test, tolerances=Tolerances(DOUBTS, damping=0.15)))
    laws = [
        Candidate((LIBRARY["uniform_damping"],), chosen=(f,))
        for f in problem.forms(LIBRARY["uniform_damping"])
    ]
    clamp, *damped_only = (explain(problem, one, laplace_only=True) for one in (CLAMP, *laws))
    pairs = [
        join(problem, (CLAMP, clamp.best.coordinates), (one.candidate, one.best.coordinates), -np.inf)
        for one in damped_only
    ]
    pairs.sort(key=lambda pair: pair.log_evidence)
    worst, best = pairs[0], pairs[-1]
    assert best.log_evidence > worst.log_evidence + 3
    others = _in_other_forms(problem, worst, [clamp, *damped_only], -np.inf)
    assert max(pair.log_evidence for pair in others) > best.log_evidence - 0.5
    assert _in_other_forms(problem, best, [clamp, *damped_only], -np.inf) == []
