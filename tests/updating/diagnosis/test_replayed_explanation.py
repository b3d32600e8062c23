"""What a figure shows of an explanation is what the diagnosis found, the form of every effect included."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_pairs_of_causes import FREE, two_sensors
from updating_cases import case_of

from modalkit.workflow.fitted import fitted
from updating import LIBRARY, diagnose


@pytest.mark.long
@pytest.mark.parametrize("names", [("polarity",), ("polarity", "E")])
def test_a_sensor_upside_down_is_put_back_as_that_sensor(names: tuple[str, ...]) -> None:
    case = case_of(two_sensors(upside_down=4), replace(FREE, masses=()))
    found = diagnose(case, library=[LIBRARY[name] for name in names])
    row = next(r for r in found.ranking if r.effects == ("polarity",))
    first = replace(found, ranking=(row,), sets=(("polarity",),), verdict="named")
    shown = fitted(first, case)
    assert shown.candidate is not None
    assert [dict(form.values) for form in shown.candidate.forms] == [{"channel": "5"}]
    assert shown.left_over is not None
    nominal = shown.problem.at(replace(shown.candidate, effects=(), chosen=()), np.zeros(0)).residual
    assert np.sum(np.abs(shown.left_over)) < 0.5 * np.sum(np.abs(nominal))
