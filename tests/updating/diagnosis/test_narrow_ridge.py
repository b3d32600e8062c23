"""The slope of the log-likelihood is right where that is far narrower than a step of differences would be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, blank, case_of, exactly

from updating import LIBRARY, Predictor
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search import slope as slopes
from updating.diagnosis.search.fit import maximise
from updating.diagnosis.search.points import evaluate
from updating.models.spec import Material
from updating.problem.candidate import Candidate

BAR = replace(
    BEAM, length=0.8, width=0.04, thickness=0.008, elements=(40,), clamped=(), theory="euler-bernoulli",
    material=Material(70e9, 2700.0, 0.33), regions=(), masses=(),
)  # fmt: skip
POINTS = np.linspace(0.0, BAR.length, 12)
TRUTH = {"mass": 0.05, "x": 0.05, "bulk": 4.0}


def test_a_slope_beside_a_narrow_ridge_is_that_of_the_likelihood() -> None:
    """Place and rotary inertia of a body near a free end are exchanged along a ridge 1e-4 of the prior wide."""
    predictor = Predictor(BAR, blank(POINTS))
    effect = LIBRARY["lumped_mass"]
    truth = predictor.predict(effect.state(predictor, TRUTH), count=6)
    noise = 0.003 * np.abs(truth.constants).max(axis=0) * np.ones_like(truth.constants)
    problem, _ = pose(case_of(exactly(predictor, truth, sigma=3e-6, constants_sigma=noise), BAR))
    candidate = Candidate((effect,), chosen=(problem.forms(effect)[-1],))
    aside = np.array(effect.quantiles(predictor, {**TRUTH, "x": 0.05016, "bulk": 3.0}))
    peak = maximise(problem, candidate, aside, rounds=0)
    width = 1 / np.sqrt(np.diag(peak.normal))
    assert width[1] < 1e-3
    for i, short in enumerate(0.01 * np.minimum(width, 0.01)):
        ends = aside + short * np.outer([1, -1], np.eye(3)[i])
        high, low = (
            evaluate(problem, candidate, end, about=peak.point.about).marginal.log_likelihood for end in ends
        )
        assert abs(peak.gradient[i] - (high - low) / (2 * short)) < 0.02 / width[i]


def test_a_slope_that_is_taken_again_takes_no_longer_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a likelihood with kinks a long step sees a narrow one and a short step a wide one: no search ends in turns."""
    taken: list[np.ndarray] = []

    def kinked(*others: object) -> slopes.Slope:
        sizes = np.asarray(others[-1])
        narrow = np.roll([1.0, 1e10], len(taken))
        taken.append(sizes)
        assert len(taken) < 50, "it goes on for ever"
        return slopes.Slope(
            columns=np.zeros((1, 2)), normal=np.diag(narrow), load=np.zeros(2), noise_gradient=np.zeros(2),
            steps=sizes, fresh=True,
        )  # fmt: skip

    monkeypatch.setattr(slopes, "_sloped", kinked)
    predictor = Predictor(BAR, blank(POINTS))
    truth = predictor.predict(count=6)
    problem, _ = pose(case_of(exactly(predictor, truth), BAR))
    two = Candidate((LIBRARY["calibration_gain"], LIBRARY["E"]))
    peak = maximise(problem, two, np.array([0.5, 0.5]), rounds=0)
    assert np.isfinite(peak.gradient).all()
    assert (np.diff(taken, axis=0) <= 0).all()
    assert len(taken) < 12
