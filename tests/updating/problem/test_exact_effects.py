"""What is no idealisation is in no doubt beside an effect that is one."""

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly

from updating import LIBRARY, Predictor
from updating.diagnosis.diagnose import pose
from updating.models.state import NOMINAL
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

E, MASS = LIBRARY["E"], LIBRARY["lumped_mass"]
FAR = 0.7
"""Quantile of a modulus that is off by per cents [-]."""


@pytest.fixture(scope="module")
def problem() -> SpecimenProblem:
    nominal = Predictor(BEAM, blank(POINTS))
    return pose(case_of(exactly(nominal, nominal.predict(count=4)), nominal.spec))[0]


def doubt(problem: SpecimenProblem, *effects: object, at: list[float]) -> np.ndarray:
    """Return the variance of the frequencies that idealisations leave, (n_modes,) [-]."""
    found = problem.at(Candidate(effects), np.array(at))  # type: ignore[arg-type]
    assert found.idealised is not None
    return np.asarray(found.idealised[found.of("frequency")])


def test_a_modulus_beside_a_body_leaves_no_more_doubt_than_the_body(problem: SpecimenProblem) -> None:
    body = [0.5, 0.4, 0.2]
    assert doubt(problem, E, MASS, at=[FAR, *body]) == pytest.approx(doubt(problem, MASS, at=body), rel=0.05)
    assert problem.at(Candidate((E,)), np.array([FAR])).idealised is None


def test_a_body_of_no_mass_leaves_none_however_far_the_modulus_is_off(problem: SpecimenProblem) -> None:
    light = [0.0, 0.4, 0.2]
    far = np.log(problem.predictor.predict(E.state(problem.predictor, {"factor": 1.3}), count=4).frequency)
    assert np.ptp(far - np.log(problem.nominal.frequency)) < 1e-6
    assert doubt(problem, E, MASS, at=[1.0, *light]).max() < 1e-3 * 0.03**2


def test_only_effects_on_the_structure_beside_idealisations_are_exact(problem: SpecimenProblem) -> None:
    stage = problem.predictor
    gain = LIBRARY["calibration_gain"]
    for effects in ((E,), (MASS,), (gain, MASS), (E, gain)):
        candidate = Candidate(effects)
        middle = [0.5] * len(candidate.parameters(stage))
        assert candidate.doubt_on(stage, candidate.split(stage, middle)).exact is NOMINAL
