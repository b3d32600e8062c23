"""Damping below what is expected, named and not: a matter of what the model's damping is doubted by."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, case_of, specimen, struck

from updating import LIBRARY, diagnose


@pytest.mark.parametrize("doubt", [0.3, pytest.param(0.1, marks=pytest.mark.long)])
def test_without_a_baseline_less_damping_shows_as_early_as_more(doubt: float) -> None:
    """Half and twice are as far from what is expected; whether that is a gap is the modeller's doubt of it alone."""
    rng = np.random.default_rng(8)
    test = struck(specimen(rng), rng)
    omega, assumed = 2 * np.pi * test.frequency, BEAM.damping
    expected = (assumed.alpha or 0.0) / (2 * omega) + (assumed.beta or 0.0) * omega / 2
    chance = []
    for share in (0.5, 2.0):
        there = replace(test, damping=share * expected, damping_sigma=0.03 * share * expected)
        case = case_of(there, BEAM.with_elements(20))
        case = replace(case, tolerances=replace(case.tolerances, damping=doubt))
        found = diagnose(case, library=[LIBRARY["uniform_damping"], LIBRARY["E"]])
        chance.append(found.p_value)
        wanted = ("none", ()) if doubt > 0.2 else ("named", (("uniform_damping",),))
        assert (found.verdict, found.sets) == wanted
    assert np.log(chance[0]) == pytest.approx(np.log(chance[1]), rel=0.1, abs=0.1)
