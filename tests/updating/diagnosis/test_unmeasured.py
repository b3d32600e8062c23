"""Modes that a test without shapes has not measured: the ranks follow from the pattern of the frequencies."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from updating_cases import BEAM, case_of, of_frequencies

from updating import Case, Predictor, diagnose
from updating.diagnosis.search.unmeasured import ranks
from updating.models.state import NOMINAL, State


@pytest.mark.parametrize("below", [0, 2])
def test_ranks_are_the_best_of_all(rng, below):
    predicted = np.sort(rng.uniform(0.0, 3.0, (6, 9)), axis=1)
    measured = np.sort(rng.uniform(0.3, 2.0, 4))
    order, cost = ranks(measured, predicted, price=2.0, spread=0.2, below=below)
    for own, chosen, least in zip(predicted, order, cost, strict=True):

        def price(some, own=own):
            passed = some[-1] - below + 1 - len(some)
            return float(np.sum(((measured - own[list(some)]) / 0.2) ** 2) / 2 + 2.0 * passed)

        every = {some: price(some) for some in combinations(range(below, 9), 4)}
        assert least == pytest.approx(min(every.values()))
        assert every[tuple(chosen.tolist())] == pytest.approx(least)


def test_a_model_with_too_few_modes_has_no_ranks():
    predicted = np.array([[0.1, 0.2, np.nan, np.nan], [0.1, 0.2, 0.3, 0.4]])
    cost = ranks(np.array([0.1, 0.2, 0.3]), predicted, price=2.0, spread=0.1)[1]
    assert np.isinf(cost[0])
    assert cost[1] == pytest.approx(0.0)


def case(state: State, missing: list[int]) -> Case:
    """A table of six frequencies, some of the lower ones not in it."""
    beam = replace(BEAM.with_elements(20), regions=())
    true = Predictor(beam, of_frequencies(np.ones(1), 1e-3)).predict(state, count=9).frequency
    kept = np.delete(true, missing)[:6] * np.exp(1e-3 * np.random.default_rng(3).standard_normal(6))
    test = replace(of_frequencies(kept, 1e-3), repeatability=1e-3)
    return case_of(test, beam)


@pytest.mark.long
@pytest.mark.parametrize(
    ("state", "verdict", "name"),
    [(NOMINAL, "none", ""), (State(factors={"density": 1.3}), "class", "density")],
)
def test_a_mode_that_is_missing_is_no_cause(state, verdict, name):
    found = diagnose(case(state, [2]))
    assert found.verdict == verdict
    assert (name,) in found.sets or not name
    assert any("lacks modes of the model: 1 between" in one for one in found.warnings)


@pytest.mark.long
def test_ranks_stand_where_something_fits():
    found = diagnose(case(State(factors={"density": 1.3}), []))
    assert ("density",) in found.sets
    assert not any("lacks modes" in one for one in found.warnings)
