"""A mass at the tip and a spring at the root that give a cantilever the very same frequencies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, STEEL, ExactBeam, case_of, of_frequencies

from updating import LIBRARY, Measured, diagnose

HEAVY = 0.05
"""Mass of the body at the tip over that of the beam [-]."""


def tipped() -> ExactBeam:
    """An Euler-Bernoulli cantilever with a body at its tip."""
    own = STEEL.density * BEAM.length * BEAM.width * BEAM.thickness
    return replace(plain(), masses=((BEAM.length, HEAVY * own),))


def plain() -> ExactBeam:
    return ExactBeam(
        BEAM.length, BEAM.width, BEAM.thickness, STEEL.E, STEEL.density, shear=False, rotary=False
    )


def sprung() -> ExactBeam:
    """The same beam without the body on a root spring k with k L / E I = 1 / HEAVY."""
    return replace(plain(), rotation=STEEL.E * plain().inertia / (HEAVY * BEAM.length))


def frequencies_alone() -> Measured:
    return of_frequencies(tipped().frequencies(5), 1e-4)


def test_the_two_beams_have_the_same_frequencies() -> None:
    assert tipped().frequencies(8) == pytest.approx(sprung().frequencies(8), rel=1e-7)
    assert np.abs(tipped().frequencies(8) / plain().frequencies(8) - 1).min() > 0.02


@pytest.mark.long
def test_frequencies_alone_name_neither_of_them() -> None:
    """Both are listed as what the data cannot separate, though one has the wider prior, and less probability."""
    case = case_of(frequencies_alone(), replace(BEAM, theory="euler-bernoulli"))
    library = [LIBRARY["clamp_rotation"], LIBRARY["lumped_mass"]]
    found = diagnose(case, library=library, rng=np.random.default_rng(0))
    assert found.significant
    assert found.verdict == "class"
    assert {("clamp_rotation",), ("lumped_mass",)} <= {tuple(effects) for effects in found.sets}
    first, second = found.ranking[:2]
    assert second.effects in first.equivalents
    assert second.probability > 0.01
