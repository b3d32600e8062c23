"""The number that selects the form of an effect is not a result."""

from __future__ import annotations

import pytest

from modalkit.output.forms import numbers_a_form
from updating.diagnosis.answer.ranked import ParameterEstimate


@pytest.mark.parametrize(
    ("name", "value", "unit", "low", "high", "form"),
    [
        ("joint_nonlinearity.joint", 0.0, "-", 0.0, 0.0, True),
        ("joint_nonlinearity.joint", 2.0, "-", None, None, True),
        ("joint_nonlinearity.slope", -8e-5, "1/N", -9e-5, -7e-5, False),
        ("E.factor", 1.0, "-", 0.98, 1.02, False),
        ("local_stiffness.loss", 0.98, "-", 0.98, 0.98, False),
        ("lumped_mass.mass", 0.0, "kg", 0.0, 0.0, False),
        ("polarity.points", (3,), "", None, None, False),
        ("position_error.point", 3.0, "", None, None, False),
        ("joint.joint", "bolt 3", "", None, None, False),
    ],
)
def test_a_whole_number_without_unit_and_doubt_is_a_form(name, value, unit, low, high, form):
    assert numbers_a_form(name, ParameterEstimate(value, unit, low, high, False)) is form
