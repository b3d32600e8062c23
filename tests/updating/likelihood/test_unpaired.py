"""Modes without a partner in the nominal model: what their data say of states that have them and that lack them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly

from updating import LIBRARY, Measured, Predictor, diagnose
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.held_out import _groups
from updating.effects.base import total_mass
from updating.likelihood.base import NO_DOUBT, Doubt
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.likelihood.outliers import Outlier, with_outliers
from updating.models.state import NOMINAL, State
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import FREE_LEVEL_DOUBT

EFFECT = LIBRARY["absorber"]
LOOK = Predictor(BEAM, blank(POINTS))
HUNG = {"x": 0.25, "mass": 0.05 * total_mass(BEAM), "frequency": 160.0, "damping": 0.02}
TEST = exactly(LOOK, LOOK.predict(EFFECT.state(LOOK, HUNG), count=6))


def posed(test: Measured = TEST) -> SpecimenProblem:
    """The beam with an absorber beside the model without."""
    problem, _ = pose(case_of(test))
    assert problem.measured.unpaired is not None
    assert len(problem.measured.unpaired.frequency) == 1
    return problem


@pytest.mark.parametrize("stated", [0.0, -1e-3, np.nan])
def test_a_mode_without_damping_leaves_the_unpaired_one_beside_the_others(stated: float) -> None:
    """It says as little as one whose damping is not stated."""
    lowest = np.arange(len(TEST.frequency)) == 0
    problem = posed(replace(TEST, damping=np.where(lowest, stated, TEST.damping)))
    unstated = posed(replace(TEST, damping=np.where(lowest, np.nan, TEST.damping)))
    found = marginal(problem.compare(NOMINAL)).log_likelihood
    assert np.isfinite(found)
    assert found == pytest.approx(marginal(unstated.compare(NOMINAL)).log_likelihood)


def known(
    problem: SpecimenProblem, doubt: Doubt = NO_DOUBT, **changes: float
) -> tuple[Comparison, np.ndarray]:
    """The test beside the absorber that it has, and the rows of its mode."""
    found = problem.compare(EFFECT.state(problem.predictor, {**HUNG, **changes}), doubt=doubt)
    assert found.stated.all()
    return found, np.flatnonzero(found.of("unpaired"))


def test_the_doubt_in_what_makes_the_mode_is_settled_with_that_of_the_others() -> None:
    """Nothing of it is left where the idealisation is just so."""
    plain, rows = known(posed())
    doubtful, _ = known(posed(), Doubt(fidelity=0.1))
    assert doubtful.variance[rows[0]] > plain.variance[rows[0]] + 1e-6
    assert doubtful.settled(0.0).variance[rows] == pytest.approx(plain.variance[rows])


@pytest.mark.parametrize("level", [1.0, 30.0])
@pytest.mark.parametrize("stated", [{"absolute": False}, {"calibration": 1.0}], ids=str)
def test_a_level_that_is_free_is_fitted_and_paid_for(level: float, stated: dict[str, Any]) -> None:
    """As that of the paired modes: whatever the amplitude, which no level tells from any other."""
    louder = {"constants": level * TEST.constants, "constants_sigma": level * TEST.constants_sigma}
    test = replace(TEST, **louder, **stated)
    found, rows = known(posed(test))
    column = found.nuisance[rows][2:]
    widest = column[:, np.argmax(np.abs(column).max(axis=0))]
    assert found.residual[rows][2:] == pytest.approx(np.zeros(len(POINTS)), abs=0.05)
    assert np.sqrt(np.mean(widest**2)) == pytest.approx(FREE_LEVEL_DOUBT, rel=0.05)


def test_a_delay_turns_the_mode_as_it_turns_the_others() -> None:
    """By half turns, which make signs of real constants, and by what the mode decays meanwhile."""
    delay, frequency = 3e-3, TEST.frequency
    turned = -2 * np.pi * frequency * delay
    half_turns = np.round(-turned / np.pi)
    grown = np.exp(2 * np.pi * frequency * TEST.damping * delay)
    phase = (turned + np.pi * half_turns)[None]
    late = replace(
        TEST,
        constants=TEST.constants * np.where(half_turns % 2, -grown, grown),
        phase=phase,
        phase_sigma=np.full_like(phase, 0.01),
        channel_group=np.zeros(len(TEST.seen), dtype=int),
    )
    problem = posed(late)
    assert half_turns[np.isclose(frequency, problem.measured.unpaired.frequency[0])] == 1  # type: ignore[union-attr]
    found = problem.compare(EFFECT.state(problem.predictor, HUNG).plus(State(delay=delay)))
    assert found.residual[found.of("unpaired")] == pytest.approx(np.zeros(2 + len(POINTS)), abs=1e-5)


def test_its_damping_is_as_doubtful_as_that_of_the_others() -> None:
    """A mode of the structure and of what hangs on it has of the structure's damping, too."""
    sharp, rows = known(posed())
    case = case_of(TEST)
    doubts = replace(case.tolerances, damping=2 * case.tolerances.damping)
    wide, _ = known(pose(replace(case, tolerances=doubts))[0])
    more = 3 * case.tolerances.damping**2
    assert wide.variance[rows[1]] - sharp.variance[rows[1]] == pytest.approx(more)


def test_a_bad_channel_is_set_aside_in_it_too() -> None:
    found, rows = known(posed())
    worse = with_outliers(found, [Outlier(source=3, scale=10.0)])
    larger = np.flatnonzero(worse.variance > 1.5 * found.variance)
    assert np.isin(rows[2 + 3], larger)
    assert set(found.source[larger].tolist()) == {3}
    assert (found.source[rows[:2]] == -1).all()


def test_points_left_out_of_a_fit_are_left_out_of_its_shape() -> None:
    problem = posed()
    groups = _groups(problem)
    assert groups is not None
    found, rows = known(problem)
    shapes = np.flatnonzero(found.scaled)
    by_point = {int(found.source[i]): int(groups[i]) for i in shapes}
    assert [by_point[int(s)] for s in found.source[rows[2:]]] == groups[rows[2:]].tolist()


PROPPED = {"x": BEAM.length, "extent": 0.0, "stiffness": 1e5, "damping": 0.0}


def test_a_state_that_has_the_mode_by_another_cause_knows_it_too() -> None:
    """A spring at the tip changes the first mode beyond recognition, and the model with that spring has it."""
    spring = LIBRARY["ground_spring"]
    problem = posed(exactly(LOOK, LOOK.predict(spring.state(LOOK, PROPPED), count=6)))
    assert not problem.compare(NOMINAL).stated.all()
    found = problem.compare(spring.state(problem.predictor, PROPPED))
    assert found.stated.all()
    assert found.residual[found.of("unpaired")] == pytest.approx(np.zeros(2 + len(POINTS)), abs=1e-6)
    off = problem.compare(spring.state(problem.predictor, {**PROPPED, "stiffness": 3e4}))
    assert not off.stated.all()


@pytest.mark.long
def test_what_explains_all_modes_needs_nothing_that_hangs_beside_it() -> None:
    spring = LIBRARY["ground_spring"]
    test = exactly(LOOK, LOOK.predict(spring.state(LOOK, PROPPED), count=6))
    found = diagnose(case_of(test), library=[spring, EFFECT, LIBRARY["E"]])
    assert found.sets == (("ground_spring",),)


@pytest.mark.long
def test_it_takes_up_as_much_of_its_neighbours_as_what_scatters_frequencies_makes_it(
    rng: np.random.Generator,
) -> None:
    """Changes of the stiffness that no model knows, by 1 % of omega_i omega_j, beside a test that states so much."""
    scatter, now = 0.01, LOOK.predict(EFFECT.state(LOOK, HUNG), count=6)
    omega, shapes = 2 * np.pi * now.frequency, now.constants / np.sqrt(np.abs(now.constants[-1]))
    found = []
    for _ in range(12):
        change = rng.standard_normal((6, 6)) * np.outer(omega, omega) * np.sqrt(2) * scatter
        values, turned = np.linalg.eigh(np.diag(omega**2) + (change + change.T) / 2)
        mixed = shapes @ turned
        test = replace(
            TEST, frequency=np.sqrt(values) / (2 * np.pi), constants=mixed * mixed[-1], repeatability=scatter
        )
        comparison, rows = known(posed(test))
        shape = rows[2:]
        own = np.diag(comparison.variance[shape]) + comparison.nuisance[shape] @ comparison.nuisance[shape].T
        found.append(comparison.residual[shape] @ np.linalg.solve(own, comparison.residual[shape]))
        assert mixed[:, 1] != pytest.approx(shapes[:, 1], rel=1e-3)
    assert np.mean(found) < len(shape)
