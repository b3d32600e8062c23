"""Points hit two and three standard deviations from where they are stated, in modes that bend within that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares
from updating_cases import BEAM, blank, exactly

from updating import Case, Measured, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.points import evaluate
from updating.effects import LIBRARY
from updating.models.state import NOMINAL, State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

MARK = 2e-3  # m
STATED = np.linspace(0.06, 0.376, 7)
AWAY = MARK * np.array([0.3, -1.1, 2.3, -0.2, 0.6, -2.7, 0.0])


def hit(points: np.ndarray, *, noise: int | None = None) -> Measured:
    """A test of points that were hit elsewhere, its constants exact or with the noise that is stated."""
    test = replace(blank(STATED, top=1400.0), position_sigma=MARK)
    truth = Predictor(BEAM, replace(test, points=points[:, None])).predict(count=6)
    sigma = 0.002 * np.sqrt(np.mean(truth.constants**2, axis=0)) * np.ones_like(truth.constants)
    found = exactly(Predictor(BEAM, test), truth, constants_sigma=sigma, repeatability=2e-4)
    if noise is None:
        return found
    rng = np.random.default_rng(noise)
    return replace(found, constants=found.constants + sigma * rng.standard_normal(sigma.shape))


def problem_of(test: Measured) -> SpecimenProblem:
    return pose(Case("a beam", BEAM, test, tolerances=Tolerances({"E": 1e-6})))[0]


def test_what_is_left_is_that_of_the_nearest_places() -> None:
    """The least misfit over where points were, found by another solver on shapes computed anew."""
    problem = problem_of(hit(STATED + AWAY, noise=3))
    point = evaluate(problem, Candidate(), np.zeros(0))
    here = point.comparison
    of, marks = here.of("frf"), here.moving[len(problem.names) : len(problem.names) + len(STATED)]
    others = np.setdiff1d(np.arange(here.nuisance.shape[1]), marks)
    root = np.sqrt(here.noise(point.marginal.scale)[of])
    scale = np.sqrt(np.mean(problem.measured.constants**2, axis=0))
    besides = here.nuisance[of][:, others]

    rows, vectors = problem.predictor.reduced.rows, problem.nominal.vectors
    sensor = problem.nominal.seen[0]

    def misfit(unknown: np.ndarray) -> np.ndarray:
        points = np.minimum(STATED + MARK * unknown[: len(STATED)], BEAM.length)[:, None]
        predicted = sensor * (
            rows(points, None)["w"][:, : len(vectors)] @ vectors
        )  # the sensor stays where it is
        left = ((problem.measured.constants - predicted) / scale).ravel() - besides @ unknown[len(STATED) :]
        return np.concatenate([left / root, unknown])

    found = least_squares(misfit, np.zeros(len(STATED) + len(others)), xtol=1e-10)
    ours = point.marginal.shift[np.append(marks, others)]
    assert ours[: len(STATED)] == pytest.approx(found.x[: len(STATED)], abs=0.05)
    assert np.sum(misfit(ours) ** 2) == pytest.approx(2 * found.cost, abs=0.3)
    assert ours[:5] == pytest.approx(AWAY[:5] / MARK, abs=0.3)
    # linearised about where they are stated it is not that
    straight = problem.compare(NOMINAL)
    assert np.abs(straight.residual - here.residual)[of].max() > 3 * root.min()


@pytest.mark.parametrize("seed", range(2))
def test_a_mark_two_or_three_sigma_off_is_no_cause(seed: int) -> None:
    problem = problem_of(hit(STATED + AWAY, noise=seed))
    nothing = explain(problem, Candidate())
    effect = LIBRARY["position_error"]
    forms = [Candidate((effect,), chosen=(form,)) for form in problem.forms(effect)]
    best = max(explain(problem, one, laplace_only=True).log_evidence for one in forms)
    assert best < nothing.log_evidence + 1.0


@pytest.mark.parametrize("what", ["nothing else", "labels exchanged", "a point moved"])
def test_the_columns_of_places_are_the_slopes_of_what_is_left(what: str) -> None:
    away, state, order = AWAY.copy(), NOMINAL, np.arange(len(STATED))
    if what == "labels exchanged":
        state, order[[1, 4]] = State(exchanged=(("hit", 1, 4),)), [4, 1]
    elif what == "a point moved":
        state = State(moved={("hit", 2): (4e-3,)})
        away[2] += 4e-3
    test = hit(STATED + away)
    problem = problem_of(replace(test, constants=test.constants[order]))
    shift = np.zeros(problem.linearised)
    marks = np.arange(len(problem.names), len(problem.names) + len(STATED) - 1)  # the last is at the end
    shift[marks] = (AWAY[order] / MARK)[:-1]  # of labelled points

    def left(about: np.ndarray) -> np.ndarray:
        there = problem.compare(state, about)
        return (there.residual - there.nuisance[:, there.moving] @ about)[there.of("frf")]

    here = problem.compare(state, shift)
    columns = here.nuisance[here.of("frf")][:, here.moving]
    assert np.abs(left(shift)).max() < 1e-6
    for i in marks:
        slope = (left(shift + 1e-4 * (np.arange(len(shift)) == i)) - left(shift)) / 1e-4
        assert slope == pytest.approx(-columns[:, i], abs=0.02 * np.abs(columns[:, i]).max())


def test_places_beside_a_baseline_stay_where_they_are_stated() -> None:
    test = hit(STATED + AWAY)
    case = Case("a beam", BEAM, test, baseline=test, tolerances=Tolerances({"E": 1e-6}))
    problem = pose(case)[0]
    assert not problem.wide and problem.linearised == len(problem.names)
