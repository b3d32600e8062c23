"""A place is where the study has it, on a structure that is longer than modelled as on one that is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank

from updating import LIBRARY, Case, Predictor
from updating.models.parts import PointMass
from updating.models.spec import Spec
from updating.nominal import predictor_of
from updating.problem.candidate import Candidate

BODY = {"mass": 0.05, "x": 0.3, "bulk": 0.0}
PLAIN = replace(BEAM, theory="euler-bernoulli", masses=())


def longer(spec: Spec, by: float, x: float) -> np.ndarray:
    """Frequencies of the beam that grew at its clamp, its points at the same distance from the tip."""
    body = PointMass((x + by * (spec.clamped == ("x0",)),), BODY["mass"])
    grown = replace(spec, length=spec.length + by, masses=(body,))
    return Predictor(grown, blank(POINTS)).predict(count=4).frequency


@pytest.mark.parametrize("extension", [0.02, -0.01])
def test_a_body_beside_an_extension_sits_where_the_study_says(extension: float) -> None:
    predictor = Predictor(PLAIN, blank(POINTS))
    candidate = Candidate((LIBRARY["length"], LIBRARY["lumped_mass"]))
    parts = [(LIBRARY["length"], {"extension": extension}), (LIBRARY["lumped_mass"], BODY)]
    expected = longer(PLAIN, extension, BODY["x"])
    for order in (parts, parts[::-1]):
        state = candidate.assemble(predictor, order)
        assert predictor.predict(state, count=4).frequency == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("first", ["length", "lumped_mass"])
def test_so_it_does_in_a_model_that_has_accepted_the_extension(first: str) -> None:
    both = {"length": {"extension": 0.02}, "lumped_mass": BODY}
    accepted = tuple(sorted(both.items(), key=lambda entry: entry[0] != first))
    found = predictor_of(Case("longer", PLAIN, blank(POINTS), accepted=accepted)).predict(count=4)
    assert found.frequency == pytest.approx(longer(PLAIN, 0.02, BODY["x"]), rel=2e-5)
