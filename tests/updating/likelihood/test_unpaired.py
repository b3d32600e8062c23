"""Modes without a partner in the nominal model: what their data say of states that have them and that lack them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly

from updating import LIBRARY, Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.effects.base import total_mass
from updating.likelihood.gaussian import marginal
from updating.models.state import NOMINAL
from updating.problem.specimen import SpecimenProblem

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
