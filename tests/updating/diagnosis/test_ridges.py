"""Ridges of the likelihood: all of what the data leave open is in the posterior, though it bends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, blank, case_of, exactly

from updating import LIBRARY, Predictor
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain, finish
from updating.diagnosis.search.ridges import along_ridge
from updating.problem.candidate import Candidate

pytestmark = pytest.mark.long

AROUND = replace(PLATE, clamped=("x0", "x1", "y0", "y1"), regions=(), masses=())
INSIDE = np.array([(x, y) for x in np.linspace(0.05, 0.35, 4) for y in (0.02, 0.1, 0.17)])
TRUTH = {"ratio": 0.84, "shear_ratio": 0.85, "coupling": 1.0}


def test_a_fully_clamped_plate_feels_shear_and_coupling_as_one_sum() -> None:
    """Integrals of w_xx w_yy and of w_xy^2 are one where the edges are clamped, so that D_1 + 2 D_xy alone shows."""
    predictor = Predictor(AROUND, blank(INSIDE))
    effect = LIBRARY["orthotropy"]
    truth = predictor.predict(effect.state(predictor, TRUTH), count=8)
    problem, _ = pose(case_of(exactly(predictor, truth), AROUND))
    candidate = Candidate((effect,))
    draft = explain(problem, candidate, laplace_only=True)
    tops = along_ridge(problem, candidate, draft.peaks[0])
    heights = [peak.point.marginal.log_likelihood for peak in tops]
    assert min(heights) > draft.best.marginal.log_likelihood - 3
    weighed = finish(problem, draft)
    values = [problem.values(candidate, u) for u in weighed.samples]
    shear = np.array([v["orthotropy.shear_ratio"] for v in values])
    coupling = np.array([v["orthotropy.coupling"] for v in values])
    nu = AROUND.material.poisson
    total = nu * coupling + (1 - nu) * shear
    mean = weighed.weights @ total
    assert mean == pytest.approx(nu * TRUTH["coupling"] + (1 - nu) * TRUTH["shear_ratio"], rel=0.02)
    assert np.sqrt(weighed.weights @ (total - mean) ** 2) < 0.02
    # what the data leave open is open: both sides of the truth are in the posterior
    for low, high in ((0.3, 0.7), (0.9, 1.5)):
        assert weighed.weights[(shear > low) & (shear < high)].sum() > 0.1


def test_where_all_is_determined_there_is_no_ridge() -> None:
    predictor = Predictor(AROUND, blank(INSIDE))
    truth = predictor.predict(LIBRARY["E"].state(predictor, {"factor": 0.9}), count=6)
    problem, _ = pose(case_of(exactly(predictor, truth), AROUND))
    candidate = Candidate((LIBRARY["E"],))
    draft = explain(problem, candidate, laplace_only=True)
    assert along_ridge(problem, candidate, draft.peaks[0]) == []
