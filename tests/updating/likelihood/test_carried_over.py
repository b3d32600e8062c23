"""What a baseline says of the present test: the ratio of two frequencies of one specimen, whatever the model misses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2
from updating_cases import BEAM, blank, case_of

from updating import Measured, Predictor
from updating.diagnosis.answer.rules import DEFAULT_RULES
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.diagnosis.search.goodness import p_values
from updating.problem.candidate import Candidate

SIGMA, REPEATABILITY, MODES, MODE = 7e-4, 1e-3, 5, 2
UNEVEN = np.array([1.0, -0.75, 0.5, -1.0, 0.25])
"""How unevenly the modes are missed, in parts of the largest miss."""


def frequencies(ratios: np.ndarray) -> Measured:
    """A test without shapes and damping, its frequencies the model's times some ratios."""
    model = Predictor(BEAM, blank(np.zeros(0)))
    frequency, nothing = model.predict(count=MODES).frequency * ratios, np.full(MODES, np.nan)
    return replace(
        model.measured,
        frequency=frequency,
        frequency_sigma=SIGMA * frequency,
        damping=nothing,
        damping_sigma=nothing,
        constants=np.zeros((0, MODES)),
        constants_sigma=np.zeros((0, MODES)),
        absolute=False,
        repeatability=REPEATABILITY,
    )


@pytest.mark.long
@pytest.mark.parametrize("missed", [0.0, 0.03, 0.12])
@pytest.mark.parametrize("change", [0.0, 0.005, 0.01, 0.03, 0.08])
def test_a_change_is_judged_by_the_noise_of_both_tests(missed: float, change: float) -> None:
    before = np.exp(missed * UNEVEN)
    after = before * np.exp(change * (np.arange(MODES) == MODE))
    problem, _ = pose(case_of(frequencies(after), baseline=frequencies(before)))
    found = p_values(explain(problem, Candidate()).best)
    expected = chi2.sf(change**2 / (2 * (SIGMA**2 + REPEATABILITY**2)), MODES)
    assert found["frequency"] == pytest.approx(expected, rel=0.02)
    assert (found["frequency"] < DEFAULT_RULES.significant_gap) == (change >= 0.01)
