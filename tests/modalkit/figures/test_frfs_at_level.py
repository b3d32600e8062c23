"""FRFs of a model whose frequencies the level of the hits shifts, beside those of one that is as much stiffer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition.form import FORMS
from modalkit.samples import sample_file
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.fitted import Fitted
from modalkit.workflow.overlaid import at_level
from updating.diagnosis.diagnose import pose
from updating.models.state import State


@pytest.mark.long
@pytest.mark.parametrize("form", FORMS)
def test_a_shift_of_all_frequencies_is_a_modulus_times_its_square(form) -> None:
    """Stiffness times s^2 and the same damping ratios: every resonance is s times as high, as Rayleigh has it."""
    session = open_study(read_study(sample_file("beam_dry/study.toml")), with_baseline=False)
    assert session.identified is not None
    problem, _ = pose(session.case)
    best, shift = Fitted(problem), 0.99
    frfs = replace(session.identified.frfs.select([0, 2]), form=form)
    model = problem.predictor

    def softer(of):
        return State(factors={"E": shift**2})

    stiffness = model.for_test(model.measured, (*model.additions, softer))
    by_stiffness = at_level(frfs, 1.0, best, stiffness)
    by_level = at_level(frfs, shift, best, model)
    assert by_level.measured.frequency == pytest.approx(by_stiffness.measured.frequency, rel=1e-12)
    assert np.array_equal(by_level.measured.values, by_stiffness.measured.values)
    size = np.abs(by_stiffness.model.values).max()
    assert by_level.model.values == pytest.approx(by_stiffness.model.values, rel=1e-6, abs=1e-6 * size)
    assert by_level.frac == pytest.approx(by_stiffness.frac, abs=1e-6)
    assert np.abs(by_level.model.values - at_level(frfs, 1.0, best, model).model.values).max() > 0.1 * size
