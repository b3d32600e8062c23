"""A tolerance that keeps a parameter from where the data would take it is named, and so is what to write instead."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from updating import Tolerances
from updating.update import update

sys.path.insert(0, str(Path(__file__).resolve().parent))
from test_doubts_by_part import frequencies, storeys

SOFT = np.array([0.0, 0.0, np.log(0.06), 0.0, 0.0])
"""Logarithms of the stiffness of five storeys, the third of which has come loose [-]."""

SIGMA = 0.01
"""What the frequencies are known to, relative [-]."""


def test_a_loose_storey_held_at_its_nominal_stiffness_is_held_by_its_tolerance() -> None:
    tight = update(storeys(SOFT, 4, Tolerances({"E": 0.01}), sigma=SIGMA), parameters=["storey_3.E"])
    assert tight.inflation > 3
    assert tight.held == ("storey_3.E",)
    assert tight.undetermined == ()
    (said,) = [w for w in tight.warnings if "storey_3.E is held by its tolerance of 1 %" in w]
    found = re.search(r"\(factor (\S+)\)", said)
    assert found is not None
    assert np.log(float(found[1]) / 0.06) == pytest.approx(
        0, abs=0.1
    )  # on a basis made for the nominal model
    assert "`bounds.storey_3.E` about that value or a tolerance of `storey_3.E = 1`" in said
    assert "HELD BY ITS TOLERANCE" in tight.report()
    assert "NOT DETERMINED" not in tight.report()
    assert "less precisely than the prior knowledge" not in tight.report()


@pytest.mark.parametrize(
    "own",
    [Tolerances({"E": 0.01}, parts={"storey_3.E": 1.0}), Tolerances(bounds={"storey_3.E": (0.01, 2.0)})],
)
def test_what_is_advised_finds_the_loose_storey(own: Tolerances) -> None:
    free = update(storeys(SOFT, 4, own, sigma=SIGMA), parameters=["storey_3.E"])
    assert free.held == free.undetermined == ()
    (found,) = free.parameters
    assert found.factor is not None
    assert abs(np.log(found.factor / 0.06)) < 3 * found.sigma / found.value
    assert not any("held by its tolerance" in w for w in free.warnings)


def test_a_storey_as_its_tolerance_says_is_not_held() -> None:
    """Data that say less than the tolerance and agree with it leave the parameter undetermined, as it is."""
    calm = update(storeys(0.1 * SOFT, 4, Tolerances({"E": 0.01}), sigma=0.2), parameters=["storey_3.E"])
    assert calm.held == ()
    assert calm.undetermined == ("storey_3.E",)


def test_a_gap_that_the_parameter_cannot_close_does_not_make_its_tolerance_hold_it() -> None:
    """Frequencies ten sigma off across what the storey's stiffness does to them ask for no other stiffness."""
    case = storeys(np.zeros(5), 4, Tolerances({"E": 0.01}), sigma=SIGMA)
    step = np.zeros(5)
    step[2] = 1e-4
    slope = np.log(frequencies(step, 4)[0] / frequencies(-step, 4)[0])
    off = np.array([1.0, -1.0, 1.0, -1.0])
    off -= slope * (slope @ off) / (slope @ slope)
    moved = case.measured.frequency * (1 + 10 * SIGMA * off)
    result = update(
        replace(case, measured=replace(case.measured, frequency=moved)), parameters=["storey_3.E"]
    )
    assert result.inflation > 3
    assert result.held == ()
