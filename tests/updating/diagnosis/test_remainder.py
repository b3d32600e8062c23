"""What an answer leaves beyond noise, and how probably each effect is among the causes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from updating import LIBRARY, Diagnosis, diagnose

BEAM = FINE.with_elements(20)
SOME = tuple(
    LIBRARY[name] for name in ("E", "density", "thickness", "length", "sensor_mass", "clamp_rotation")
)


@cache
def answer(what: str) -> Diagnosis:
    """A beam with nothing hidden, a softer one, and the softer one whose second mode was read 2 % too high."""
    rng = np.random.default_rng(11)
    beam = specimen(rng)
    test = struck(beam if what == "nothing" else replace(beam, E=0.9 * beam.E), rng)
    if what == "a mode misread":
        test = replace(
            test, frequency=test.frequency * np.where(np.arange(len(test.frequency)) == 1, 1.02, 1.0)
        )
    return diagnose(case_of(test, BEAM), library=SOME)


@pytest.mark.long
def test_where_there_is_no_gap_nothing_is_left() -> None:
    found = answer("nothing")
    assert found.verdict == "none"
    assert found.remainder is None


@pytest.mark.long
def test_a_true_cause_leaves_nothing_beyond_noise() -> None:
    left = answer("softer").remainder
    assert left is not None
    assert not left.significant
    assert left.carried_by == ()
    assert left.sigma < 4


@pytest.mark.long
def test_the_remainder_names_mode_and_kind() -> None:
    found = answer("a mode misread")
    left = found.remainder
    assert left is not None
    assert left.significant
    assert "mode 2 frequency" in left.carried_by
    assert left.sigma > 5
    assert "mode 2 frequency" in str(left)


@pytest.mark.long
@pytest.mark.parametrize("what", ["softer", "a mode misread"])
def test_an_effect_is_included_as_often_as_the_sets_that_hold_it(what: str) -> None:
    found = answer(what)
    for name, share in found.included.items():
        rows = sum(row.probability for row in found.ranking if name in row.effects)
        assert share == pytest.approx(rows, abs=1e-9)
        assert 0 <= share <= 1 + 1e-9
    if what == "softer":
        # frequencies of a beam rise alike with either, and its level hardly tells them apart
        first = sorted(found.included, key=lambda name: -found.included[name])
        assert set(first[:2]) == {"E", "thickness"}
