"""Many places of a candidate at once are each of them by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, DOUBTS, POINTS, blank, case_of, exactly

from updating import LIBRARY, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.points import evaluate, evaluate_many
from updating.problem.candidate import Candidate


@pytest.mark.parametrize("wider", [1.0, 30.0])
def test_many_places_at_once(wider: float) -> None:
    """With tolerances for one linearisation, and with some that need several."""
    predictor = Predictor(BEAM, blank(POINTS))
    test = exactly(predictor, predictor.predict(count=4))
    doubts = Tolerances({name: wider * sigma for name, sigma in DOUBTS.items()})
    problem = pose(replace(case_of(test, BEAM), tolerances=doubts))[0]
    candidate = Candidate((LIBRARY["E"], LIBRARY["lumped_mass"]))
    places = np.random.default_rng(3).random((5, len(problem.parameters(candidate))))
    for place, found in zip(places, evaluate_many(problem, candidate, places), strict=True):
        alone = evaluate(problem, candidate, place)
        # rounding that several linearisations hand on: 1e-5 of a probability
        assert found.marginal.log_likelihood == pytest.approx(alone.marginal.log_likelihood, rel=0, abs=1e-5)
        np.testing.assert_allclose(found.marginal.shift, alone.marginal.shift, rtol=1e-6, atol=1e-6)
        assert (found.about is None) == (alone.about is None)
