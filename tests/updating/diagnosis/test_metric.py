"""In which terms a gap is stated: in those of the channel that carries it, of the shapes where no other does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from updating import Measured
from updating.diagnosis.answer.metric import metric_of
from updating.diagnosis.diagnose import pose
from updating.models.state import NOMINAL

BEAM = FINE.with_elements(20)


def changed(what: str) -> Measured:
    rng = np.random.default_rng(7)
    test = struck(specimen(rng), rng)
    third = np.arange(len(test.frequency)) == 2
    louder = np.where(test.hit == 3, 1.8, 1.0)[:, None]
    both = {"frequency": test.frequency * np.where(third, 1.05, 1.0), "constants": test.constants * louder}
    return replace(test, **{name: both[name] for name in what.split()})


@pytest.mark.parametrize(
    ("what", "metric"),
    [("frequency", "frequency"), ("constants", "frf"), ("frequency constants", "frequency")],
)
def test_the_metric_is_that_of_what_carries_the_gap(what: str, metric: str) -> None:
    """With the noise that its explanation leaves; ten times as large, no shape would surprise."""
    problem, _ = pose(case_of(changed(what), BEAM))
    found = problem.compare(NOMINAL).settled(1.0)
    assert metric_of(found, found, 1.0) == metric
