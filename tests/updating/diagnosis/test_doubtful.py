"""What looks like a slip is said as such, and once a cause explains it, that the answer rests on it."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from updating.diagnosis.problem.doubtful import notes_on_doubtful

MODEL = np.array([20.0, 125.0, 350.0, 686.0, 1134.0, 1694.0])


@dataclass(frozen=True)
class Posed:
    """A test beside a model, as far as frequencies go."""

    measured: SimpleNamespace
    nominal: SimpleNamespace


def posed(ratio: np.ndarray) -> Posed:
    return Posed(SimpleNamespace(frequency=ratio * MODEL), SimpleNamespace(frequency=MODEL))


@pytest.mark.parametrize("explained", ["", "ground_spring"])
def test_a_lone_mode_is_stated_with_what_rests_on_it(explained: str) -> None:
    (note,) = notes_on_doubtful(posed(np.array([1.2, 1.0, 1.001, 1.0, 0.999, 1.0])), explained)  # type: ignore[arg-type]
    assert "24.00 Hz deviates from the others" in note
    assert ("check for a mistake or a wrong pair" in note) is not bool(explained)
    assert (f"{explained} explains it and depends on it" in note) is bool(explained)


def test_a_structure_that_a_cause_explains_is_not_called_another() -> None:
    wet = posed(np.full(len(MODEL), 0.5))
    assert "probably different structures" in notes_on_doubtful(wet)[0]  # type: ignore[arg-type]
    assert notes_on_doubtful(wet, "fluid_added_mass") == []  # type: ignore[arg-type]
