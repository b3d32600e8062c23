"""Wood: a plate ten times as stiff along the grain as across it."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, blank, case_of, exactly

from updating import LIBRARY, Predictor
from updating.diagnosis.answer.verdict import estimates
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.models.spec import Material
from updating.models.state import State
from updating.problem.candidate import Candidate

pytestmark = pytest.mark.long

SPRUCE = Material(10.9e9, 416.0, 0.3)
BOARD = replace(PLATE, length=0.58, width=0.217, thickness=0.0049, clamped=(), material=SPRUCE)
GRID = np.array([[x, y] for x in (0.05, 0.29, 0.5) for y in (0.02, 0.15)])


@pytest.mark.parametrize("ratio", [0.09, 11.0])
def test_the_ratio_of_wood_is_within_what_is_searched(ratio: float) -> None:
    board = Predictor(BOARD, blank(GRID, top=500.0))
    effect = LIBRARY["orthotropy"]
    truth = board.predict(effect.state(board, {"ratio": ratio, "shear_ratio": 0.55}), count=8)
    problem, _ = pose(case_of(exactly(board, truth, sigma=1e-3), BOARD))
    found = explain(problem, Candidate((effect,)), laplace_only=True)
    size = estimates(problem, found)["orthotropy.ratio"]
    assert not problem.parameters(found.candidate)[0][1].extreme(float(found.best.coordinates[0]))
    assert size.value == pytest.approx(ratio, rel=0.05)


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_a_modulus_off_its_tolerance_scales_both_directions(theory: str) -> None:
    """Wood with a third of the modulus has all of its frequencies by the root of it, across the grain as along it."""
    board = Predictor(replace(BOARD, theory=theory), blank(GRID, top=500.0))
    state = LIBRARY["orthotropy"].state(board, {"ratio": 0.09, "shear_ratio": 0.55})
    stated, softer = (
        board.predict(state.plus(State(factors={"E": factor})), factors=("E",), count=8)
        for factor in (1.0, 1 / 3)
    )
    assert softer.frequency == pytest.approx(stated.frequency / np.sqrt(3), rel=1e-6)
    assert stated.log_frequency_by == pytest.approx(0.5, abs=1e-6)
