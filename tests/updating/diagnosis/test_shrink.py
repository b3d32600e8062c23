"""How far a gap shrinks: before, after, held out, and what may be claimed of it."""

from dataclasses import replace

import numpy as np
import pytest
from test_next_test import case_of

from updating.diagnosis.answer.metric import Squares, squares
from updating.diagnosis.answer.shrink import closed, shrinkage
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.fit import maximise
from updating.diagnosis.search.held_out import believed, modes_held_out
from updating.effects import LIBRARY
from updating.likelihood.comparison import Comparison
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import BELIEVED_DOUBT


@pytest.fixture(scope="module")
def problem() -> SpecimenProblem:
    return pose(case_of(0.85))[0]


def test_a_gap_of_the_modulus_closes_to_the_noise(problem: SpecimenProblem) -> None:
    nothing, best = explain(problem, Candidate()), explain(problem, Candidate((LIBRARY["E"],)))
    found = shrinkage(problem, nothing, best, None, np.random.default_rng(1))
    assert found.metric == "frequency"
    assert found.before == pytest.approx(100 * (1 / np.sqrt(0.85) - 1), rel=1e-3)
    assert found.after < found.floor
    assert found.held_after < found.floor
    assert found.closed is not None
    assert found.closed.value > 99
    assert found.held_runner_up is None


def test_tolerances_alone_close_no_more_than_is_believed_of_them(problem: SpecimenProblem) -> None:
    """The modulus is 15 % off and good to 1 %: all doubts at three sigma make up for a part of it."""
    nothing, best = explain(problem, Candidate()), explain(problem, Candidate((LIBRARY["E"],)))
    found = shrinkage(problem, nothing, best, None, np.random.default_rng(1))
    assert found.stretch > BELIEVED_DOUBT
    assert problem.theory_error is not None
    most = 3 * (0.5 * 0.01 + 0.5 * 0.003 + 0.005 + 2 * 0.002 + problem.theory_error.width.mean())
    gap = 0.5 * np.log(1 / 0.85)
    assert found.held_nuisance == pytest.approx(100 * np.expm1(gap - most), rel=0.05)


def test_held_out_modes_are_those_of_a_full_refit(problem: SpecimenProblem) -> None:
    best = explain(problem, Candidate((LIBRARY["clamp_rotation"],)))
    fast = modes_held_out(problem, best)
    mode = best.best.comparison.mode
    for m in np.unique(mode):
        keep = mode != m
        point = maximise(problem, best.candidate, best.best.coordinates, keep=keep).point
        assert fast[~keep] == pytest.approx(point.left_over[~keep], abs=2e-4)


def test_bounds_do_not_touch_what_stays_within_them() -> None:
    rng = np.random.default_rng(3)
    columns, residual = rng.normal(size=(8, 2)), 0.5 * rng.normal(size=8)
    from types import SimpleNamespace

    one = Comparison(
        residual=residual,
        nuisance=columns,
        variance=np.ones(8),
        channel=np.zeros(8, dtype=int),
        mode=np.arange(8),
        source=np.full(8, -1),
        predictions=(SimpleNamespace(),),
        scale_prior=(1.0,),
        doubts=np.arange(2),
        tolerances=np.arange(0),
    )
    ridge = np.linalg.solve(np.eye(2) + columns.T @ columns, columns.T @ residual)
    assert believed(one, 1.0) == pytest.approx(residual - columns @ ridge)
    far = replace(one, residual=residual + 100 * columns[:, 0])
    assert np.abs(believed(far, 1.0)).max() > 10


def test_with_one_mode_nothing_can_be_held_out() -> None:
    case = case_of(0.85)
    single = pose(replace(case, measured=case.measured.modes(np.array([0]))))[0]
    nothing, best = explain(single, Candidate()), explain(single, Candidate((LIBRARY["E"],)))
    found = shrinkage(single, nothing, best, None, np.random.default_rng(1))
    assert np.isnan(found.held_after)
    assert found.closed is None


def test_nothing_closes_within_the_floor() -> None:
    count = np.ones(4)
    small, floor = Squares(1.2 * count, count), Squares(count, count)
    assert closed(small, floor, floor, np.random.default_rng(1)) is None


def test_the_share_is_that_of_the_closable_gap() -> None:
    count = np.ones(400)
    before, after, floor = (Squares(x * count, count) for x in (101.0, 21.0, 1.0))
    share = closed(before, after, floor, np.random.default_rng(1))
    assert share is not None
    assert share.value == pytest.approx(80.0)
    assert share.low95 < 80 < share.high95


def test_a_turned_mode_is_off_by_its_angle_in_all_constants() -> None:
    from types import SimpleNamespace

    channel = np.array([0, 2, 2, 2, 2, 3])
    one = Comparison(
        residual=np.zeros(6),
        nuisance=np.zeros((6, 0)),
        variance=np.ones(6),
        channel=channel,
        mode=np.zeros(6, dtype=int),
        source=np.full(6, -1),
        predictions=(SimpleNamespace(),),
        scale_prior=(1.0,),
        doubts=np.arange(0),
        tolerances=np.arange(0),
    )
    turned = squares(np.array([0.5, 0.0, 0.0, 0.0, 0.0, 0.02]), one, "frf")
    assert turned.rms == pytest.approx(0.02)
    assert squares(np.array([0.1, 0, 0, 0, 0, 0.0]), one, "frequency").rms == pytest.approx(1 - np.exp(-0.1))
