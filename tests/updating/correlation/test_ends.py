"""The direction of every point by which FRAC is listed: a node that is measured along two axes is two points."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from updating.correlation.correlate import correlate

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "update"))
from test_doubts_by_part import storeys

from updating import Tolerances


def test_shapes_of_a_node_along_two_axes_are_distinguished() -> None:
    case = storeys(np.zeros(4), 3, Tolerances({"E": 0.01}), shapes=0.01)
    case = replace(case, measured=replace(case.measured, absolute=True))
    assert correlate(case).frac["response direction"].tolist() == ["+X"] * 4
    assert correlate(case).frac["force direction"].tolist() == [None] * 4
    assert correlate(case).frac["FRAC"].to_numpy() == pytest.approx(np.ones(4), abs=1e-6)
