"""A place that an explanation's form fixes, an end or a test point, is among its parameters, with the points' doubt."""

from __future__ import annotations

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, exactly

from updating import LIBRARY, Case, Predictor, Tolerances
from updating.diagnosis.answer.verdict import estimates
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.problem.candidate import Candidate

SIGMA = 2e-3


@pytest.mark.parametrize("place", [float(x) for x in np.ravel(POINTS)[1:3]])
def test_a_body_at_a_test_point_has_a_place(place: float) -> None:
    body = LIBRARY["lumped_mass"]
    beam = Predictor(BEAM, blank(POINTS))
    truth = beam.predict(body.state(beam, {"mass": 0.02, "x": place, "bulk": 1.0}), count=4)
    test = exactly(beam, truth, position_sigma=SIGMA)
    problem, _ = pose(Case("a body", BEAM, test, tolerances=Tolerances({"E": 0.01})))
    form = next(f for f in problem.forms(body) if f.values.get("x") == pytest.approx(place))
    found = estimates(problem, explain(problem, Candidate((body,), chosen=(form,)), laplace_only=True))
    at = found["lumped_mass.x"]
    assert (at.value, at.unit) == (pytest.approx(place), "m")
    assert at.low95 == pytest.approx(place - 1.96 * SIGMA)
    assert at.high95 == pytest.approx(min(place + 1.96 * SIGMA, BEAM.length))
