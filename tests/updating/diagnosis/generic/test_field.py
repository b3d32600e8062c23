"""A cause that is in no library: its evidence by brute force, its place, and none beside the true cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, observed

from updating import LIBRARY, Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.diagnosis.generic.columns import compared
from updating.diagnosis.generic.field import Grid, beside
from updating.diagnosis.search.evidence import explain
from updating.likelihood.gaussian import marginal
from updating.models.parts import Region
from updating.models.spec import Spec
from updating.models.state import NOMINAL, State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

HALVES = tuple(
    Region(name, x=(low * BEAM.length, high * BEAM.length))
    for name, low, high in (("root", 0.0, 0.5), ("tip", 0.5, 1.0))
)
TENTHS = replace(BEAM.with_elements(10), regions=())


def problem(state: State, spec: Spec = TENTHS) -> SpecimenProblem:
    """A test of the model itself in some state, with noise."""
    found = Predictor(spec, blank(POINTS)).predict(state, count=5)
    test: Measured = observed(
        found.frequency, found.damping, found.constants, POINTS, np.random.default_rng(4)
    )
    return pose(case_of(test, spec))[0]


def test_without_a_field_it_is_the_evidence_of_the_search() -> None:
    posed = problem(State(factors={"E": 0.8}))
    nothing = explain(posed, Candidate())
    found = marginal(compared(posed, nothing, np.zeros((2, 11)))).log_likelihood
    assert found == pytest.approx(nothing.log_evidence, abs=1e-9)


@pytest.mark.long
def test_evidence_of_a_small_field_by_brute_force() -> None:
    """The mean likelihood over a thousand fields drawn from the prior of each kind."""
    posed = problem(State(factors={"E": 0.97}), replace(TENTHS, regions=HALVES))
    nothing, rng = explain(posed, Candidate()), np.random.default_rng(2)
    grid = Grid(amplitudes=(0.03,), lengths=(1e-3,), losses=(0.0,), gains=(0.0,))
    logs = []
    for kind in ([1, 0], [0, 1], [1, 1]):
        fields = 0.03 * rng.standard_normal((1000, 2, 3)) * np.array(kind)[:, None]
        logs += [marginal(compared(posed, nothing, one)).log_likelihood for one in fields]
    expected = np.logaddexp.reduce(logs) - np.log(len(logs)) - nothing.log_evidence
    assert beside(posed, nothing, grid=grid).log_factor == pytest.approx(expected, abs=0.3)


def test_a_field_is_found_where_it_is() -> None:
    posed = problem(State(regional={(3, "E"): 0.7}))
    found = beside(posed, explain(posed, Candidate()))
    assert found.log_factor > 6
    assert np.argmin(found.changes[0]) == 3
    assert found.changes[0, 3] == pytest.approx(np.log(0.7), abs=0.15)


@pytest.mark.long
def test_nothing_is_left_beside_the_true_cause() -> None:
    posed = problem(State(factors={"E": 0.85}))
    true = explain(posed, Candidate((LIBRARY["E"],)))
    assert beside(posed, true).log_factor < 0
    assert beside(posed, explain(posed, Candidate())).log_factor > 6


def test_nothing_is_found_where_nothing_is() -> None:
    posed = problem(NOMINAL)
    assert beside(posed, explain(posed, Candidate())).log_factor < 0
