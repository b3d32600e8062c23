"""A search for a local effect begins where it is, whatever its size: against exact beams and a finer model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, PLATE, ExactBeam, blank, case_of, exactly, observed

from updating import LIBRARY, Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.fit import maximise
from updating.problem.candidate import Candidate
from updating.problem.screening import basins, beside

FREE = replace(BEAM, clamped=(), theory="euler-bernoulli")
ALONG = np.linspace(0.0, BEAM.length, 9)
HALF_A_STEP = 0.5 / 28
"""Of the grid of five modes, relative to the length."""

WHOLE = 7850.0 * BEAM.length * BEAM.width * BEAM.thickness


def with_bodies(*bodies: tuple[float, float]) -> ExactBeam:
    """An exact free beam with bodies: where over the length, and how heavy over the beam."""
    masses = tuple((place * BEAM.length, share * WHOLE) for place, share in bodies)
    size = BEAM.length, BEAM.width, BEAM.thickness
    return ExactBeam(*size, shear=False, rotary=False, clamped=False, masses=masses)


def hit(beam: ExactBeam, seed: int = 0) -> Measured:
    """Five modes of an exact beam at nine points."""
    frequency = beam.frequencies(5)
    shape = beam.shapes(frequency, ALONG)
    return observed(frequency, np.full(5, 0.005), shape * shape[-1], ALONG, np.random.default_rng(seed))


def single(name: str, form: int = -1) -> Candidate:
    predictor = Predictor(FREE, blank(ALONG))
    variants = [v for v in LIBRARY[name].variants(predictor) if "x" not in v.values]
    return Candidate((LIBRARY[name],), chosen=(variants[form],))


@pytest.mark.parametrize("place", [0.07, 0.13, 0.29, 0.5, 0.66, 0.79, 0.94])
@pytest.mark.parametrize("share", [0.02, 0.1])
def test_a_body_on_an_exact_free_beam_is_in_the_first_two_basins(place: float, share: float) -> None:
    """The mirror image, which frequencies alone do not tell from it, may be the other."""
    problem = pose(case_of(hit(with_bodies((place, share))), FREE))[0]
    found = basins(single("lumped_mass"), problem.predictor)
    assert min(abs(u[1] - place) for u in found[:2]) < 1.5 * HALF_A_STEP


@pytest.mark.parametrize("place", [0.13, 0.5, 0.66])
def test_the_search_reaches_what_the_truth_reaches(place: float) -> None:
    problem = pose(case_of(hit(with_bodies((place, 0.08))), FREE))[0]
    candidate = single("lumped_mass")
    values = {"lumped_mass.mass": 0.08 * WHOLE, "lumped_mass.x": place * BEAM.length, "lumped_mass.bulk": 0.0}
    top = maximise(problem, candidate, candidate.coordinates(problem.predictor, values)).point
    found = explain(problem, candidate, laplace_only=True).best
    assert found.marginal.log_likelihood > top.marginal.log_likelihood - 0.3


@pytest.mark.parametrize(
    ("name", "form", "values"),
    [
        ("local_stiffness", 0, {"x": 0.22, "extent": 0.02, "loss": 0.4}),
        ("local_stiffness", 1, {"x": 0.22, "extent": 0.03, "loss": -1.0}),
        ("local_mass", 0, {"x": 0.12, "extent": 0.06, "factor": 1.8}),
        ("ground_spring", 1, {"x": 0.3, "stiffness": 2e4}),
    ],
)
def test_a_local_change_is_in_the_first_two_basins(name: str, form: int, values: dict[str, float]) -> None:
    finer = Predictor(replace(FREE, elements=(64,)), blank(ALONG))
    test = exactly(finer, finer.predict(LIBRARY[name].state(finer, values), count=5))
    problem = pose(case_of(test, FREE))[0]
    found = basins(single(name, form), problem.predictor)
    x = [p for p, _ in single(name, form).parameters(problem.predictor)].index(f"{name}.x")
    assert min(abs(u[x] - values["x"] / FREE.length) for u in found[:2]) < 3 * HALF_A_STEP


@pytest.mark.long
def test_a_body_on_a_plate_is_in_the_first_four_basins() -> None:
    """Of a plate that is its own mirror image both ways."""
    spec = replace(PLATE, clamped=())
    points = np.array([[x, y] for x in np.linspace(0, 0.376, 5) for y in np.linspace(0, 0.2, 4)])
    finer = Predictor(replace(spec, elements=(18, 12)), blank(points, top=900.0))
    body = {"x": 0.24, "y": 0.07, "mass": 0.06, "bulk": 0.0}
    test = exactly(finer, finer.predict(LIBRARY["lumped_mass"].state(finer, body), count=6))
    problem = pose(case_of(test, spec))[0]
    found = basins(single("lumped_mass"), problem.predictor)
    assert min(np.hypot((u[1] - 0.24 / 0.376), (u[2] - 0.07 / 0.2)) for u in found[:4]) < 0.1


@pytest.mark.parametrize("bodies", [((0.32, 0.05), (0.8, 0.08)), ((0.1, 0.06), (0.45, 0.03))])
def test_two_bodies_are_placed_from_where_one_alone_is(bodies: tuple[tuple[float, float], ...]) -> None:
    """One alone lies between them, or at their mirror image."""
    problem = pose(case_of(hit(with_bodies(*bodies)), FREE))[0]
    one = single("lumped_mass")
    alone = basins(one, problem.predictor)[0]
    found = beside([(one, alone), (one, alone)], problem.predictor)
    assert found is not None
    both = sorted(found[[1, 4]])
    assert min(np.abs(np.subtract(both, x)).max() for x in _mirrored(bodies)) < 2 * HALF_A_STEP


def _mirrored(bodies: tuple[tuple[float, float], ...]) -> list[list[float]]:
    places = [place for place, _ in bodies]
    return [sorted(places), sorted(1 - place for place in places)]


@pytest.mark.parametrize("name", ["E", "position_error", "polarity", "sensor_mass"])
def test_what_has_no_place_stays_where_it_is_and_a_body_is_placed_beside_it(name: str) -> None:
    problem = pose(case_of(hit(with_bodies((0.3, 0.05))), FREE))[0]
    other = Candidate((LIBRARY[name],), chosen=(problem.forms(LIBRARY[name])[0],))
    start = np.full(len(problem.parameters(other)), 0.5)
    found = beside([(other, start), (single("lumped_mass"), np.full(3, 0.5))], problem.predictor)
    assert found is not None
    assert found[: len(start)] == pytest.approx(start)
    assert min(abs(found[-2] - 0.3), abs(found[-2] - 0.7)) < 3 * HALF_A_STEP
    assert beside([(other, start)] * 2, problem.predictor) is None


def test_an_effect_with_unknowns_of_its_own_is_no_place_to_search_from() -> None:
    clamped = replace(FREE, clamped=("x0",))
    problem = pose(case_of(hit(with_bodies((0.3, 0.05))), clamped))[0]
    soft = Candidate((LIBRARY["clamp_rotation"],))
    parts = [(soft, np.array([0.5])), (single("lumped_mass"), np.full(3, 0.5))]
    assert beside(parts, problem.predictor) is None


def test_a_place_that_a_form_fixes_and_pairs_are_not_screened() -> None:
    predictor = Predictor(FREE, blank(ALONG))
    effect = LIBRARY["lumped_mass"]
    fixed = next(form for form in effect.variants(predictor) if "x" in form.values)
    assert basins(Candidate((effect,), chosen=(fixed,)), predictor) == []
    assert basins(Candidate((effect, LIBRARY["ground_spring"])), predictor) == []
    assert basins(Candidate((LIBRARY["E"],)), predictor) == []
