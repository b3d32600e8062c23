"""How far an answer truly closes the gap: known where the answer is the truth, or nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modalkit.blind.answer import Answer, Estimate, Row
from modalkit.blind.shrunk import put_in, true_shrinkage
from modalkit.blind.trial import Trial, draw_trial
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.scene import nominal_scene

CLEAR = DrawRanges(kinds=("beam",), mild=0.0, strong=0.0, pairs=0.0, baseline=0.0)


def hide(name: str, index: int = 0, *, baseline: float = 0.0) -> Trial:
    return draw_trial(19, index, plan=replace(CLEAR, effects=(name,), baseline=baseline))


def message(*names: str, **values: float) -> Answer:
    numbers = {key.replace("__", "."): Estimate(v) for key, v in values.items()}
    row = Row(frozenset(names), 0.97, parameters=numbers)
    return Answer("named", (row.effects,), (row,))


def truly(trial: Trial) -> Answer:
    numbers = {k: Estimate(v) for k, v in trial.truth.parameters.items() if isinstance(v, float)}
    points = {
        k: tuple(v) if isinstance(v, list) else (v,)
        for k, v in trial.truth.parameters.items()
        if isinstance(v, (list, int))
    }
    row = Row(frozenset(trial.truth.effects), 0.97, parameters=numbers, points=points)
    return Answer("named", (row.effects,), (row,))


@pytest.mark.parametrize(
    "name",
    ["E", "density", "length", "clamp_rotation", "lumped_mass", "axial_load", "fluid_added_mass", "shear"],
)
def test_the_truth_closes_the_gap_on_modes_it_was_not_fitted_to(name: str) -> None:
    trial = hide(name)
    found = true_shrinkage(trial, truly(trial))
    assert found is not None and found.metric == "frequency"
    assert found.before_percent == pytest.approx(trial.truth.gap_percent, rel=1e-3)
    assert found.after_percent < 0.1 * found.before_percent
    assert found.beyond_after_percent < 0.25 * found.beyond_before_percent


def test_nothing_hidden_and_little_said_leaves_what_tolerances_do() -> None:
    trial = hide("none")
    found = true_shrinkage(trial, message("E", E__factor=1.0))
    assert found is not None
    assert found.after_percent < 0.2 * found.before_percent  # the tolerances alone explain the scatter


def test_wrong_cause_closes_less_beyond_the_band() -> None:
    trial = hide("clamp_translation")
    right = true_shrinkage(trial, truly(trial))
    wrong = true_shrinkage(trial, message("E", E__factor=0.9))
    assert right is not None and wrong is not None
    assert right.beyond_after_percent < 0.5 * wrong.beyond_after_percent


@pytest.mark.parametrize("index", range(5))
def test_soft_place_counts_by_its_compliance(index: int) -> None:
    """A dip, a box or a crack, softer or stiffer: a smooth one counts as a box of six tenths of its extent."""
    trial = hide("local_stiffness", index)
    numbers = trial.truth.parameters
    place = {"x": numbers["local_stiffness.x"], "compliance": numbers["local_stiffness.compliance"]}
    left = []
    for share in (1.0, 0.6):
        stated = place | {"extent": share * numbers["local_stiffness.extent"], "loss": 0.5}
        answer = message("local_stiffness", **{f"local_stiffness__{k}": v for k, v in stated.items()})
        found = true_shrinkage(trial, answer)
        assert found is not None
        left.append(found.after_percent / found.before_percent)
    assert min(left) < 0.2


def test_an_answer_without_shear_gets_none() -> None:
    trial = hide("shear")  # a slender theory for a stocky beam
    found = true_shrinkage(trial, message("calibration_gain", calibration_gain__gain=1.1))
    right = true_shrinkage(trial, truly(trial))
    assert found is not None and right is not None
    assert right.beyond_after_percent < 0.1 * found.beyond_after_percent


def test_damping_is_measured_as_damping() -> None:
    trial = hide("exponential_window", baseline=1.0)
    found = true_shrinkage(trial, truly(trial))
    assert found is not None and found.metric == "damping"
    assert found.after_percent < 0.02 * found.before_percent


def test_baseline_takes_the_place_of_tolerances() -> None:
    trial = hide("thickness", baseline=1.0)
    found = true_shrinkage(trial, truly(trial))
    assert found is not None
    factor = trial.truth.parameters["thickness.factor"]
    assert found.before_percent == pytest.approx(100 * abs(1 / factor - 1), rel=0.1)
    assert found.after_percent < 0.05 * found.before_percent


def test_pair_needs_both() -> None:
    trial = draw_trial(
        19,
        1,
        plan=replace(CLEAR, effects=("E", "lumped_mass"), none=0.0, outside=0.0, pairs=1.0, baseline=1.0),
    )
    both = true_shrinkage(trial, truly(trial))
    numbers = trial.truth.parameters
    one = true_shrinkage(trial, message("E", E__factor=numbers["E.factor"]))
    assert both is not None and one is not None
    assert both.after_percent < 0.3 * one.after_percent


@pytest.mark.parametrize(
    "answer",
    [
        Answer("none", ()),
        Answer("unknown", ()),
        message("gravity", gravity__g=9.8),
        message("ground_spring", ground_spring__stiffness=3.0),
        message("lumped_mass", lumped_mass__mass=0.1),
        message("E", E__factor=float("nan")),
        message("E", E__factor=0.0),
    ],
)
def test_what_the_rig_cannot_put_in_has_no_shrinkage(answer: Answer) -> None:
    assert true_shrinkage(hide("E"), answer) is None


@pytest.mark.parametrize("force", [-1.5, -1e4])
def test_a_load_that_buckles_the_body_has_no_shrinkage(force: float) -> None:
    trial = hide("axial_load")
    setup = trial.scene.setup
    ends = 4.0 if len(setup.clamped) == 2 else 0.25
    buckling = ends * setup.rigidity * (np.pi / setup.length) ** 2
    assert true_shrinkage(trial, message("axial_load", axial_load__force=force * buckling)) is None
    assert true_shrinkage(trial, message("axial_load", axial_load__force=-0.5 * buckling)) is not None


def test_points_and_labels_are_put_in() -> None:
    setup = hide("E").scene.setup
    row = Row(frozenset({"polarity"}), 1.0, points={"polarity.points": (2, 3)})
    scene = put_in(nominal_scene(setup), row)
    assert scene is not None and scene.chain.reversed == (1, 2)
    row = Row(
        frozenset({"position_error"}),
        1.0,
        parameters={"position_error.dx": Estimate(0.01)},
        points={"position_error.point": (3,)},
    )
    scene = put_in(nominal_scene(setup), row)
    assert scene is not None
    np.testing.assert_allclose(scene.chain.moved[2], [0.01])
