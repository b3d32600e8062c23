"""Pairs that the study states follow their mode where a change of the model makes modes cross."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from updating.diagnosis.diagnose import pose
from updating.prediction.assignment import match


def test_a_stated_pair_is_a_mode_and_no_rank() -> None:
    test = struck(specimen(np.random.default_rng(2)), np.random.default_rng(3))
    count = len(test.frequency)
    problem, _ = pose(case_of(replace(test, partners=np.arange(count)), FINE.with_elements(20)))
    assert problem.measured.partner_constants is not None
    now = problem.predictor.predict()
    crossed = np.arange(len(now.frequency))
    crossed[[1, 2]] = crossed[[2, 1]]
    found = match(problem.measured, now.select(crossed), problem.order)
    assert found.tolist()[:3] == [0, 2, 1]
