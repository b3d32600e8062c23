"""What beams miss of a plate's bending: against the energy of a strip, and bricks that CalculiX solved."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calculix_bricks import Bricks, isotropic, modes, needs_ccx
from updating_cases import blank

from updating import Material, PointMass, Predictor, Spec, Tolerances
from updating.models.width import across_width
from updating.problem.candidate import Candidate
from updating.problem.gates import notes_on
from updating.problem.specimen import SpecimenProblem
from updating.problem.theory_error import theory_error

NOWHERE = np.zeros(0)


def beam(width: float, *, poisson: float = 0.3, clamped: tuple[str, ...] = ("x0",)) -> Spec:
    return Spec(
        "beam",
        length=0.4,
        width=width,
        thickness=0.002,
        elements=(30,),
        clamped=clamped,
        theory="timoshenko",
        material=Material(200e9, 7800.0, poisson),
    )


@pytest.mark.parametrize("width", [0.02, 0.03, 0.05])
@pytest.mark.parametrize("poisson", [0.2, 0.3])
def test_a_clamp_shortens_a_beam_by_a_share_of_its_width(width: float, poisson: float) -> None:
    lowest = across_width(beam(width, poisson=poisson), np.arange(1), NOWHERE).stiffening[0]
    shorter = poisson**2 * width * np.sqrt((1 - poisson) / 6)
    assert lowest == pytest.approx(2 * shorter / 0.4, rel=0.1)


def test_a_free_beam_misses_more_the_higher_the_mode_and_nothing_without_poisson() -> None:
    found = across_width(beam(0.03, clamped=()), np.arange(5), NOWHERE).stiffening
    assert np.all(np.diff(found) > 0)
    assert 0 < found[0] < 1e-3
    assert not across_width(beam(0.03, poisson=0.0), np.arange(5), NOWHERE).stiffening.any()


def test_a_plate_misses_nothing() -> None:
    plate = Spec(
        "plate",
        length=0.4,
        width=0.03,
        thickness=0.002,
        elements=(30, 4),
        clamped=("x0",),
        theory="mindlin",
        material=Material(200e9, 7800.0, 0.3),
    )
    assert not across_width(plate, np.arange(3), NOWHERE).stiffening.any()


@needs_ccx
def test_bricks_are_as_much_stiffer(tmp_path: Path) -> None:
    length, width, thickness = 0.437, 0.05, 0.004
    near = thickness * np.array([0.25, 0.5, 1.0, 2.0])
    along = np.unique(np.concatenate([np.linspace(0, length, 33), near]))
    bricks = Bricks(tuple(along), tuple(np.linspace(0, width, 7)), thickness, isotropic(205e9, 0.3), 7850.0)
    points = np.array([[x, width / 2] for x in along[8::6]])
    frequency, shapes = modes(tmp_path, bricks, 14, points)
    bending = frequency[np.abs(shapes).max(axis=0) > 0.2 * np.abs(shapes).max()][:4]
    spec = Spec(
        "beam",
        length=length,
        width=width,
        thickness=thickness,
        elements=(40,),
        clamped=("x0",),
        theory="timoshenko",
        material=Material(205e9, 7850.0, 0.3),
    )
    own = Predictor(spec, blank(np.array([length]))).predict(count=4).frequency
    assert np.log(bending / own) == pytest.approx(
        across_width(spec, np.arange(4), NOWHERE).stiffening, abs=1e-3
    )


def test_a_remark_stands_where_it_is_more_than_the_noise() -> None:
    test = blank(np.array([0.4]))
    order = np.arange(len(test.frequency))
    assert test.repeatability < 1e-3
    for width, remarked in ((0.04, True), (0.001, False)):
        found = theory_error(Predictor(beam(width), test), order)
        assert (
            any('type = "plate" includes both' in note for note in notes_on(found, test, beam(width)))
            == remarked
        )


def test_frequencies_may_be_higher_by_it_and_a_beam_of_no_width_by_nothing() -> None:
    test = blank(np.array([0.4]))
    predictor = Predictor(beam(0.04), test)
    order = np.arange(len(test.frequency))
    problem = SpecimenProblem(
        predictor=predictor,
        measured=test,
        tolerances=Tolerances(),
        order=order,
        theory_error=theory_error(predictor, order),
    )
    nuisance = problem.at(Candidate(), np.zeros(0)).nuisance
    assert any(
        np.allclose(column[order], across_width(predictor.spec, order, NOWHERE).stiffening)
        for column in nuisance.T
    )


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_the_middle_line_moves_by_the_curvature_beyond_the_mean(theory: str) -> None:
    """nu b^2 / 24 w'', away from the ends, of waves that are long beside the width."""
    spec = replace(beam(0.03, clamped=()), theory=theory)
    x = np.linspace(0.12, 0.28, 33)
    found = across_width(spec, np.arange(2), x)
    curvature = np.gradient(np.gradient(found.shape, x, axis=0), x, axis=0)
    inner = slice(3, -3)
    assert found.line[inner] == pytest.approx(0.3 * 0.03**2 / 24 * curvature[inner], rel=0.1, abs=2e-4)


def test_a_body_on_the_middle_line_bends_the_section_under_it() -> None:
    """Its inertia moves its place more, by the square of the frequency: what a beam has no part of."""
    x = np.array([0.4])
    heavy = replace(beam(0.05), masses=(PointMass((0.4,), 0.005),))
    bare, loaded = (across_width(one, np.arange(3), x) for one in (beam(0.05), heavy))
    more = (loaded.line / loaded.shape - bare.line / bare.shape)[0]
    assert more[2] > more[1] > more[0] > 0
