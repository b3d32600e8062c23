"""Cords of a free test beside transfer matrices and first order, and where they cannot be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import LOOK
from updating_cases import BEAM, ExactBeam

from updating import LIBRARY, Predictor
from updating.effects.base import total_mass

EFFECT = LIBRARY["suspension"]
EI = 210e9 * BEAM.width * BEAM.thickness**3 / 12
UNIT = EI / BEAM.length**3
SIZE = (BEAM.length, BEAM.width, BEAM.thickness)
ATOM = 1e-4


def plate() -> Predictor:
    """The plate without its clamp."""
    return LOOK["plate"].of(replace(LOOK["plate"].spec, clamped=()))


def test_it_needs_a_free_specimen() -> None:
    assert EFFECT.why_not(LOOK["free"]) is None
    assert "clamped" in str(EFFECT.why_not(LOOK["beam"]))
    assert "ground_spring" in str(EFFECT.why_not(LOOK["matrices"]))


@pytest.mark.parametrize("ratio", [2.0, 40.0])
@pytest.mark.parametrize("inset", [0.0, 0.1, 0.3])
def test_two_cords_under_a_free_beam(ratio: float, inset: float) -> None:
    """A foundation of 0.1 mm at one cord and a spring's jump at the other, by transfer matrices."""
    free = LOOK["free"]
    values = {"stiffness": ratio * UNIT, "inset": inset, "cords": 2.0, "damping": 0.0}
    found = free.predict(EFFECT.state(free, values), count=4).frequency
    near, far = inset * BEAM.length, (1 - inset) * BEAM.length
    beds = [(max(x - ATOM / 2, 0.0), min(x + ATOM / 2, BEAM.length), ratio * UNIT) for x in (near, far)]
    exact = ExactBeam(*SIZE, shear=False, rotary=False, clamped=False, beds=tuple(beds)).frequencies(6)[2:]
    assert found == pytest.approx(exact, rel=3e-4)


@pytest.mark.parametrize("cords", [2, 3, 4])
def test_cords_of_a_plate_move_modes_as_first_order_says(cords: int) -> None:
    """A free square's corners move alike in every mode: n cords of k / n shift all alike, and damp them alike."""
    free = plate()
    values = {"stiffness": 60.0 / cords, "damping": 0.0, "inset": 0.0, "cords": float(cords)}
    sprung, damped, bare = (
        free.predict(EFFECT.state(free, {**values, "stiffness": k, "damping": c}), count=4)
        for k, c in ((60.0 / cords, 0.0), (0.0, 0.3 / cords), (0.0, 0.0))
    )
    corner = free.reduced.rows(np.zeros((1, 2)))["w"][0] @ bare.vectors
    rise = (2 * np.pi) ** 2 * (sprung.frequency**2 - bare.frequency**2)
    rate = 4 * np.pi * (damped.damping - bare.damping) * bare.frequency
    assert rise == pytest.approx(60.0 * corner**2, rel=2e-2)
    assert rate == pytest.approx(0.3 * corner**2, rel=2e-2)


@pytest.mark.parametrize("place", ["beam", "plate"])
def test_cords_at_the_ends_of_the_prior_are_soft_and_firm(place: str) -> None:
    """The whole bounces at the share of the first elastic frequency that the prior says."""
    free = LOOK["free"] if place == "beam" else plate()
    first = free.predict(count=1).frequency[0]
    stiffness = EFFECT.parameters(free)[0]
    for value, cords, share in ((stiffness.low, 4, 0.03), (stiffness.high, 2, 0.7)):
        bounce = np.sqrt(cords * value / total_mass(free.spec)) / (2 * np.pi)
        assert bounce == pytest.approx(share * first)


def test_it_says_how_many_cords() -> None:
    assert EFFECT.derived(LOOK["free"], {"cords": 3.0, "inset": 0.1}) == {"number": (3.0, "-")}
    assert len(EFFECT.locations(LOOK["free"], {"cords": 3.0, "inset": 0.1})) == 3
