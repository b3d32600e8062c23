"""Whether the fuller theory of a model shows in the data of a test."""

from __future__ import annotations

import numpy as np

from updating.prediction.assignment import match
from updating.problem.specimen import SpecimenProblem
from updating.thresholds import LEAST_CONSTANT_NOISE, LEAST_FREQUENCY_NOISE


def theory_shows(problem: SpecimenProblem, *, part: float = 0.3) -> bool:
    """Return whether the fuller theory moves frequencies or shapes by more than a part of the noise.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model, whatever was put into the model beforehand included.
    part : float
        Part of the noise of a frequency, or of the constants of a mode on average [-]: less adds a tenth to the
        variance. Doubled: a bias of half a sigma goes unseen.
    """
    theory, test, here = problem.predictor.spec.fuller, problem.measured, problem.nominal
    if theory is None:
        return False
    there = problem.predictor.under(theory).predict(at_least=problem.reach)
    there = there.select(match(test, there, problem.order))
    noise = np.hypot(test.frequency_sigma / test.frequency, max(test.repeatability, LEAST_FREQUENCY_NOISE))
    if np.any(np.abs(np.log(there.frequency / here.frequency)) > part * noise):
        return True
    if not test.has_shapes:
        return False
    level = np.sum(there.constants * here.constants, axis=0) / np.sum(here.constants**2, axis=0)
    moved = there.constants / level - here.constants
    size = np.linalg.norm(test.constants, axis=0) / np.linalg.norm(here.constants, axis=0)
    least = LEAST_CONSTANT_NOISE * np.sqrt(np.mean(test.constants**2, axis=0))
    share = np.sqrt(np.mean((moved * size) ** 2 / (test.constants_sigma**2 + least**2), axis=0))
    return bool(np.any(share > part))
