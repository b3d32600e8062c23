"""One of two clamps gives way: limits in closed form, and what is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank

from acquisition.errors import StudyError
from updating import LIBRARY, Predictor

BOTH = replace(BEAM, clamped=("x0", "x1"), theory="euler-bernoulli", regions=())
PREDICTOR = Predictor(BOTH, blank(POINTS - 0.03))
HINGED = {"all": (np.pi, 2 * np.pi), "x0": (3.926602, 7.068583), "x1": (3.926602, 7.068583)}
"""Roots of the frequency equation of thin beams, hinged at both ends and at one; Blevins (1979), Table 8-1."""
RIGIDITY = 210e9 * BOTH.width * BOTH.thickness**3 / 12


def frequencies(support: str, stiffness: float, name: str = "clamp_rotation") -> np.ndarray:
    state = LIBRARY[name].state(PREDICTOR, {"stiffness": stiffness, "support": support})
    return PREDICTOR.predict(state, count=2).frequency


@pytest.mark.parametrize("support", list(HINGED))
def test_a_clamp_without_stiffness_is_a_hinge_and_the_other_holds(support: str) -> None:
    roots = np.array(HINGED[support])
    mass = 7850 * BOTH.width * BOTH.thickness
    expected = (roots / BOTH.length) ** 2 * np.sqrt(RIGIDITY / mass) / (2 * np.pi)
    assert frequencies(support, 1e-6 * RIGIDITY / BOTH.length) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("name", ["clamp_rotation", "clamp_translation"])
@pytest.mark.parametrize("support", list(HINGED))
def test_a_clamp_that_nothing_moves_is_the_model(name: str, support: str) -> None:
    power = 1 if name == "clamp_rotation" else 3
    stiff = 1e7 * RIGIDITY / BOTH.length**power
    assert frequencies(support, stiff, name) == pytest.approx(PREDICTOR.predict(count=2).frequency, rel=5e-5)


def test_all_clamps_alike_and_each_alone_are_forms_with_places_of_their_own() -> None:
    effect = LIBRARY["clamp_rotation"]
    forms = effect.variants(PREDICTOR)
    assert [form.values["support"] for form in forms] == ["all", "x0", "x1"]
    assert sum(form.weight for form in forms) == pytest.approx(1.0)
    places = [[x for x, _, _ in effect.locations(PREDICTOR, form.values)] for form in forms]
    assert places == [[0.0, BOTH.length], [0.0], [BOTH.length]]
    assert "x1" in effect.sentence(forms[2].values)
    (only,) = effect.variants(Predictor(replace(BOTH, clamped=("x0",)), blank(POINTS)))
    assert "support" not in only.values


def test_an_edge_that_is_free_cannot_be_named() -> None:
    with pytest.raises(StudyError, match="not a clamped edge; those are x0, x1"):
        frequencies("y0", 1.0)


def test_clamps_of_a_beam_are_no_two_causes_of_one_kind() -> None:
    """Each is a form that holds the other firmly: two of them at once would hold both."""
    assert not LIBRARY["clamp_rotation"].repeats_on(PREDICTOR)
