"""What a body's mass and place change is what a model of another body says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, PLATE, POINTS, blank, exactly

from updating import Case, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.models.parts import PointMass
from updating.models.state import State
from updating.prediction.bodies import displaced
from updating.prediction.prediction import Prediction
from updating.problem.candidate import Candidate
from updating.thresholds import STATED_MASS_DOUBT

MASS = 0.2
MODES = 4


def carrying(spec: Spec, at: tuple[float, ...], mass: float = MASS, gyration: float = 0.0) -> Spec:
    return replace(spec, masses=(PointMass(at, mass, inertia=gyration**2 * mass),))


def points_of(spec: Spec) -> np.ndarray:
    return (
        POINTS
        if spec.kind == "beam"
        else spec.length * np.array([[0.2, 0.1], [0.45, 0.3], [0.7, 0.15], [0.9, 0.2]])
    )


def at_rest(spec: Spec, names: tuple[str, ...] = ()) -> Prediction:
    return Predictor(spec, blank(points_of(spec))).predict(factors=names, count=MODES)


@pytest.mark.parametrize(
    ("spec", "axis"), [(BEAM, 0), (PLATE, 0), (PLATE, 1)], ids=["beam x", "plate x", "plate y"]
)
def test_a_body_elsewhere_is_another_model(spec: Spec, axis: int) -> None:
    at = middle(spec)
    step = 1e-4 * spec.length
    here = at_rest(carrying(spec, at), (f"mass 1 {'xy'[axis]}",))
    moved = [tuple(x + by * (i == axis) for i, x in enumerate(at)) for by in (-step, step)]
    agree(here, *(at_rest(carrying(spec, place)) for place in moved), 2 * step)


@pytest.mark.parametrize("spec", [BEAM, PLATE], ids=["beam", "plate"])
def test_a_heavier_body_is_another_model_with_its_rotary_inertia(spec: Spec) -> None:
    at, gyration, step = middle(spec), 0.02, 1e-4
    here = at_rest(carrying(spec, at, gyration=gyration), ("mass 1",))
    others = (carrying(spec, at, MASS * np.exp(by), gyration) for by in (-step, step))
    agree(here, *(at_rest(other) for other in others), 2 * step)


def middle(spec: Spec) -> tuple[float, ...]:
    return (0.62 * spec.length, 0.21 * spec.length)[: spec.dim]


def agree(here: Prediction, low: Prediction, high: Prediction, step: float) -> None:
    by = (np.log(high.frequency) - np.log(low.frequency)) / step
    assert here.log_frequency_by[:, 0] == pytest.approx(by, rel=1e-3, abs=1e-3 * np.abs(by).max())
    constants = (high.constants - low.constants) / step
    size = np.abs(constants).max()
    assert size > 0
    assert here.constants_by[..., 0] == pytest.approx(constants, rel=5e-3, abs=5e-3 * size)


@pytest.mark.parametrize("fuller", [False, True])
def test_a_body_is_in_doubt_under_every_theory(fuller: bool) -> None:
    beam = replace(carrying(BEAM, middle(BEAM)), theory="euler-bernoulli")
    predictor = Predictor(beam, blank(POINTS))
    test = exactly(predictor, predictor.predict(count=MODES))
    problem, _ = pose(Case("a body", beam, test, tolerances=Tolerances({"E": 0.05})))
    heavier = np.array([3.0 * (name == "mass 1") for name in problem.names])
    state = Candidate(fuller=fuller).state(problem.predictor, np.zeros(0))
    found = problem.compare(state, heavier).prediction.frequency
    mass = MASS * np.exp(3 * STATED_MASS_DOUBT)
    other = replace(carrying(beam, middle(beam), mass), theory="timoshenko" if fuller else beam.theory)
    assert found == pytest.approx(at_rest(other).frequency, rel=1e-6)


def test_a_model_without_bodies_has_none_in_doubt() -> None:
    assert Predictor(BEAM, blank(POINTS)).body_changes == {}


@pytest.mark.parametrize("away", [-0.4, 0.05, 3.0])
def test_a_body_far_from_its_place_is_another_model_on_the_structure(away: float) -> None:
    """Also where it would lie beside the plate: its place is then the edge."""
    predictor = Predictor(carrying(PLATE, middle(PLATE)), blank(points_of(PLATE)))
    x, y = middle(PLATE)
    gain = displaced(
        predictor.reduced, predictor.spec, predictor.body_changes, {"mass 1 x": away, "mass 1": 0.1}
    )
    found = predictor.predict(State(mass=gain), count=MODES).frequency
    at = (min(max(x + away, 0.0), PLATE.length), y)
    other = at_rest(carrying(PLATE, at, MASS * np.exp(0.1))).frequency
    assert found == pytest.approx(other, rel=2e-3)  # the basis is that of the body at its stated place
