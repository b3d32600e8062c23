"""A model on which an accepted absorber hangs: its degree of freedom lies in no region and moves with the modes."""

from __future__ import annotations

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly

from updating import LIBRARY, Predictor
from updating.diagnosis.diagnose import pose
from updating.effects.base import total_mass
from updating.localisation import METHODS, Localiser
from updating.localisation.shapes import serep, shapes_of
from updating.models.state import State
from updating.problem.specimen import SpecimenProblem

HUNG = {"x": 0.25, "mass": 0.05 * total_mass(BEAM), "frequency": 160.0, "damping": 0.0}


def accepted(change: State | None = None) -> SpecimenProblem:
    """A test of the beam with the absorber and a change, beside the model with the absorber."""
    predictor = Predictor(BEAM, blank(POINTS))
    state = LIBRARY["absorber"].state(predictor, HUNG).plus(change or State())
    test = exactly(predictor, predictor.predict(state, count=5))
    return pose(case_of(test, accepted=(("absorber", HUNG),)))[0]


def test_expanded_shapes_of_the_model_itself_leave_no_force() -> None:
    """(K - w^2 M) phi = 0 of the structure with the degree of freedom of the absorber."""
    shapes = shapes_of(accepted())
    whole = serep(shapes)
    force = shapes.stiffness @ whole - shapes.mass @ whole * shapes.omega**2
    assert np.linalg.norm(force, axis=0) == pytest.approx(
        0.0, abs=1e-3 * np.linalg.norm(shapes.stiffness @ whole)
    )
    assert np.diag(whole.T @ shapes.mass @ whole) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("method", [m for m in METHODS.values() if m.needs_shapes], ids=repr)
def test_methods_of_shapes_have_a_score_for_every_region(method: Localiser) -> None:
    scores = method.scores(accepted(State(regional={(6, "E"): 0.6})))
    assert scores.shape == (10,)
    assert np.isfinite(scores).all()
    assert scores.max() > 0
