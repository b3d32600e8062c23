"""Single causes are known to the caller while a diagnosis goes on."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from modalkit.workflow.diagnosis import diagnose_studies
from updating.effects import LIBRARY
from updating.steps import SingleCause

STUDY = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry" / "published.toml"
EXAMINED = ("E", "length", "sensor_mass", "local_stiffness")


def test_single_causes_come_with_the_evidence_that_the_answer_has() -> None:
    """Their differences are those of the logarithms of the probabilities in the ranking."""
    found: list[SingleCause] = []
    answer = diagnose_studies([STUDY], without=[n for n in LIBRARY if n not in EXAMINED], found=found.append)
    assert found[0] == SingleCause("", 0.0, found[0].p_value)
    last = {one.name: one for one in found}
    assert set(last) == {"", *EXAMINED}
    rows = [row for row in answer.ranking if len(row.effects) == 1 and row.probability > 1e-5]
    assert len(rows) == len(EXAMINED)
    for better, worse in pairwise(rows):
        ratio = np.log(better.probability / worse.probability)
        own = last[better.effects[0]].log_evidence - last[worse.effects[0]].log_evidence
        assert own == pytest.approx(ratio, abs=0.1)
        assert last[better.effects[0]].p_value == pytest.approx(better.p_value, rel=0.01)
