"""The shear coefficient of a section: stated, against an exact beam; not stated, a doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, DOUBTS, ExactBeam, blank, exactly

from updating import Case, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.models.parts import Region
from updating.models.terms import shear_coefficient
from updating.problem.candidate import Candidate
from updating.problem.shear import slackening

THICK = replace(BEAM, length=0.12, thickness=0.02, regions=())
ORDER = np.arange(4)


def section(shear: float | None) -> Spec:
    return replace(
        THICK,
        regions=(
            Region("tube", (0.0, THICK.length), area=THICK.width * THICK.thickness, shear_coefficient=shear),
        ),
    )


@pytest.mark.parametrize("softness", [1.0, 1.7])
def test_a_stated_coefficient_gives_the_frequencies_of_the_exact_beam(softness: float) -> None:
    points = np.linspace(0.03, THICK.length, 4)
    predictor = Predictor(section(shear_coefficient(0.3) / softness), blank(points, top=5e4))
    exact = ExactBeam(THICK.length, THICK.width, THICK.thickness, softness=softness).frequencies(4)
    assert predictor.predict(count=4).frequency == pytest.approx(exact, rel=1e-4)


def test_one_that_is_not_stated_is_a_doubt_that_grows_with_the_mode() -> None:
    softer = section(0.6 * shear_coefficient(0.3))
    expected = [
        np.log(Predictor(s, blank(np.array([0.1]))).predict(count=4).frequency) for s in (softer, THICK)
    ]
    doubt = slackening(section(None), ORDER)
    assert doubt == pytest.approx(expected[0] - expected[1], abs=1e-6)
    assert (np.diff(doubt) < 0).all()
    assert doubt[-1] < -0.03


@pytest.mark.parametrize(
    "spec",
    [THICK, section(0.5), replace(section(None), theory="euler-bernoulli")],
    ids=["none", "stated", "thin"],
)
def test_what_is_known_or_not_modelled_is_no_doubt(spec: Spec) -> None:
    assert slackening(spec, ORDER) == pytest.approx(0.0)


def test_a_section_softer_than_it_was_taken_for_is_within_tolerances() -> None:
    points = np.linspace(0.03, THICK.length, 4)
    soft = Predictor(section(0.55), blank(points, top=3e4))
    test = exactly(soft, soft.predict(count=4))
    rectangle, doubted = (
        explain(pose(Case("a beam", spec, test, tolerances=Tolerances(DOUBTS)))[0], Candidate())
        for spec in (THICK, section(None))
    )
    assert rectangle.p_value < 0.001
    assert doubted.p_value > 0.05
