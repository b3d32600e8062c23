"""Feet and joints that give way in several directions at once, in a frame that the test puts together itself."""

from __future__ import annotations

import numpy as np
import pytest
from space_frame import ARM, TOP_2, Hidden, case, nearest

from updating import LIBRARY, Diagnosis, diagnose

PLACES = {
    "column": (0.0, 0.0, 0.3), "foot": (0.0, 0.0, 0.15), "leg": (0.5, 0.1, 0.38 / 3), "knee": (0.5, 0.1, 0.76 / 3),
    "beam": (1 / 6, 1 / 30, 0.45 - 0.07 / 3), "far": (1 / 3, 1 / 15, 0.45 - 0.14 / 3), "arm": ARM, "top": TOP_2,
}  # fmt: skip
AXES = {
    "column": "xy",
    "foot": "x",
    "leg": "y",
    "knee": "xy",
    "beam": "yz",
    "far": "z",
    "arm": "xyz",
    "top": "xy",
}
POINTS = [(nearest(PLACES[name]), "xyz".index(axis)) for name, axes in AXES.items() for axis in axes]
RIVALS = ("clamp_rotation", "clamp_translation", "joint", "local_stiffness", "lumped_mass", "E")
HELD = 1e10


def diagnosed(hidden: Hidden) -> Diagnosis:
    return diagnose(case(hidden, POINTS), library=[LIBRARY[name] for name in RIVALS])


@pytest.mark.long
def test_a_foot_that_shifts_in_all_directions_is_named_with_its_stiffness() -> None:
    found = diagnosed(Hidden(feet={1: (3e6, 3e6, 3e6, HELD, HELD, HELD)}))
    assert (found.verdict, found.sets) == ("named", (("clamp_translation",),))
    assert found.where.names == ("foot_2",)
    assert found.ranking[0].forms[0]["direction"] == "all"
    assert found.ranking[0].parameters["clamp_translation.stiffness"].value == pytest.approx(3e6, rel=0.02)


@pytest.mark.slow
def test_a_foot_that_turns_in_all_directions_is_named_with_its_stiffness() -> None:
    found = diagnosed(Hidden(feet={0: (1e12, 1e12, 1e12, 4e3, 4e3, 4e3)}))
    assert (found.verdict, found.sets) == ("named", (("clamp_rotation",),))
    assert found.where.names == ("foot_1",)
    assert found.ranking[0].parameters["clamp_rotation.stiffness"].value == pytest.approx(4e3, rel=0.03)


@pytest.mark.slow
def test_a_foot_that_gives_way_in_all_six_is_named_as_both(recwarn: pytest.WarningsRecorder) -> None:
    found = diagnosed(Hidden(feet={1: (3e6, 3e6, 3e6, 8e3, 8e3, 8e3)}))
    assert found.verdict == "named"
    assert set(found.sets[0]) == {"clamp_rotation", "clamp_translation"}
    own = found.ranking[0].parameters
    assert own["clamp_translation.stiffness"].value == pytest.approx(3e6, rel=0.05)
    assert own["clamp_rotation.stiffness"].value == pytest.approx(8e3, rel=0.1)


@pytest.mark.long
def test_a_bolt_that_shifts_in_all_directions_is_named_with_its_stiffness() -> None:
    found = diagnosed(Hidden(joint=(0.01, 0.01, 0.01, 1.0, 1.0, 1.0)))
    assert (found.verdict, found.sets) == ("named", (("joint",),))
    assert found.where.names == ("bolt",)
    assert found.ranking[0].parameters["joint.of_modelled"].value == pytest.approx(0.01, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("left", [0.01, 0.03])
def test_a_bolt_that_gives_way_in_all_six_is_named_with_both(left: float) -> None:
    found = diagnosed(Hidden(joint=left))
    assert (found.verdict, found.sets) == ("named", (("joint",),))
    own = found.ranking[0].parameters
    for name in ("joint.of_modelled", "joint.of_modelled_turning"):
        value = own[name].value
        assert isinstance(value, float)
        assert np.log(value / left) == pytest.approx(0.0, abs=0.15)
