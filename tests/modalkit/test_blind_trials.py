"""What is hidden, and what the study tells."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, fields

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.blind.scene import draw_scene
from modalkit.blind.setup import Setup
from modalkit.blind.study import study_text
from modalkit.blind.trial import draw_trial
from modalkit.blind.truths import SECRETS

NAMES = [secret.name for secret in SECRETS]


def frequencies(trial_scene: object) -> np.ndarray:
    scene = trial_scene
    skip = 0 if scene.setup.clamped else 2  # type: ignore[attr-defined]
    return scene.modes().frequency[skip : skip + scene.setup.modes]  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", NAMES)
def test_every_secret_moves_what_physics_says(name: str) -> None:
    trial = draw_trial(8, 0, effects=[name])
    scene, before = trial.scene, trial.before
    assert trial.truth.effect == name
    shift = frequencies(scene) / frequencies(before) - 1
    value = next(iter(trial.truth.parameters.values()), None)
    if name in ("none", "shear", "calibration_gain", "exponential_window"):
        assert np.abs(shift).max() == 0
    elif name in ("E", "thickness"):
        assert np.sign(shift) == pytest.approx(np.sign(value - 1) * np.ones(len(shift)))
    elif name == "density":
        assert np.sign(shift) == pytest.approx(-np.sign(value - 1) * np.ones(len(shift)))
    elif "spring" in name:
        assert np.all(shift > -1e-9)
    elif name != "taper":
        assert np.all(shift < 1e-9)
    assert (scene.gain != before.gain) == (name == "calibration_gain")
    assert (scene.window != before.window) == (name == "exponential_window")
    assert (trial.truth.visibility > 0) == (name != "none")
    assert trial.truth.in_library == (name not in ("ground_spring", "tip_spring", "taper"))


def test_shear_is_hidden_only_where_a_slender_theory_is_stated() -> None:
    setups = [draw_trial(3, i).scene.setup for i in range(12)]
    shear = [draw_trial(3, i, effects=["shear"]).scene.setup for i in range(4)]
    assert all(s.theory == "euler-bernoulli" and not s.baseline for s in shear)
    for i, setup in enumerate(setups):
        hidden = draw_trial(3, i).truth.effect
        if setup.theory == "euler-bernoulli" and hidden != "shear":
            assert setup.shear_shift < setup.repeatability


def test_trials_repeat_and_differ() -> None:
    assert draw_trial(1, 4).truth == draw_trial(1, 4).truth
    assert draw_trial(1, 4).scene.setup == draw_trial(1, 4).scene.setup
    assert draw_trial(1, 4).scene.setup != draw_trial(1, 5).scene.setup
    assert draw_trial(1, 4).scene.setup != draw_trial(2, 4).scene.setup


def test_unknown_effect_is_refused() -> None:
    with pytest.raises(StudyError, match=r"cannot hide.*gravity"):
        draw_trial(1, 0, effects=["gravity"])


def test_specimens_scatter_by_the_stated_tolerances() -> None:
    setup = draw_trial(6, 0, effects=["none"]).scene.setup
    rng = np.random.default_rng(1)
    scenes = [draw_scene(setup, rng) for _ in range(400)]
    drawn = np.array([[s.beam.E, s.beam.density, s.beam.thickness, s.beam.length, s.gain] for s in scenes])
    nominal = [setup.E, setup.density, setup.thickness, setup.length, 1.0]
    sigma = [0.01, 0.003, 0.005, 0.002, setup.calibration]
    assert (drawn / nominal).std(axis=0) == pytest.approx(sigma, rel=0.15)
    assert {s.beam.end for s in scenes} == {setup.length}


def study_of(setup: Setup) -> dict[str, object]:
    return tomllib.loads(study_text(setup, test_file="test.uff", baseline_file="baseline.uff"))


def test_study_states_the_setup_and_nothing_else() -> None:
    for index in range(12):
        trial = draw_trial(9, index)
        setup = trial.scene.setup
        study = study_of(setup)
        model, test = study["model"], study["test"]
        assert isinstance(model, dict)
        assert isinstance(test, dict)
        assert (model["length"], model["elements"]) == (setup.length, setup.elements)
        assert model["clamped"] == (["x0"] if setup.clamped else [])
        assert test["exponential_window"] == setup.window
        assert study["tolerances"] == asdict(setup.tolerances)
        assert ("baseline" in study) == setup.baseline
        assert set(study) <= {"title", "test", "baseline", "model", "tolerances", "environment"}
        text = study_text(setup, test_file="test.uff", baseline_file="baseline.uff")
        hidden = [repr(v) for v in trial.truth.parameters.values()]
        assert not any(value in text for value in hidden if len(value) > 8)


def test_statements_do_not_depend_on_the_effect() -> None:
    assert not {f.name for f in fields(Setup)} & {"effect", "truth", "secret", "parameters"}
    plain = [draw_trial(12, i, effects=["none"]).scene.setup for i in range(6)]
    hidden = [draw_trial(12, i, effects=["E"]).scene.setup for i in range(6)]
    assert [study_of(s) for s in plain] == [study_of(s) for s in hidden]
