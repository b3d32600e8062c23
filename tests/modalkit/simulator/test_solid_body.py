"""The rig's solids by CalculiX against its beams and plates, where these are right, and where they are not."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.blind.answer import Answer, Estimate, Row
from modalkit.blind.shrunk import true_shrinkage
from modalkit.blind.trial import draw_trial, gap_percent, write_trial
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.complex_modes import complex_modes
from modalkit.simulator.bodies.parts import Attached, Stretch
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.plate.plate import Plate
from modalkit.simulator.bodies.solid import deck as solid_deck
from modalkit.simulator.bodies.solid.solid import Cut, Solid, available
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.drawing.specimen import draw_setup
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.scene import nominal_scene
from modalkit.study.read import read_study

needs_ccx = pytest.mark.skipif(not available(), reason="no ccx: apt-get install calculix-ccx")

BAR = Solid(0.0, 0.5, 0.03, 0.008, 210e9, 7850.0, kind="beam", poisson=0.0)
BEAM = Beam(0.0, 0.5, 0.03, 0.008, 210e9, 7850.0, poisson=0.0)


@needs_ccx
def test_bar_is_the_beam() -> None:
    """Without Poisson's effect the clamp holds nothing that a beam's does not."""
    omega, shapes = BAR.real_modes(6)
    beam, beam_shapes = BEAM.real_modes(6)
    np.testing.assert_allclose(omega, beam, rtol=6e-4)
    x = np.array([[0.1], [0.33], [0.47]])
    for ours, theirs in (("w", "w"), ("slope", "slope")):
        read, known = BAR.rows(x, ours) @ shapes, BEAM.rows(x, theirs) @ beam_shapes
        assert np.abs(np.abs(read) - np.abs(known)).max() < 0.01 * np.abs(known).max()


@pytest.mark.long
@needs_ccx
def test_bricks_have_converged_and_give_the_same_twice() -> None:
    fine, _ = replace(BAR, elements=(60, 2, 2)).real_modes(5)
    coarse, _ = BAR.real_modes(5)
    np.testing.assert_allclose(coarse, fine, rtol=5e-4)
    text = solid_deck.deck(
        BAR.bricks, E=BAR.E, density=BAR.density, poisson=0.0, held=BAR._held(), points=[], count=3
    )
    read = BAR.bricks.bottom().ravel()
    first, second = (solid_deck.run(text, read=read) for _ in range(2))
    np.testing.assert_array_equal(first[0], second[0])
    np.testing.assert_array_equal(first[1], second[1])


@needs_ccx
def test_what_hangs_on_a_bar_counts_as_on_a_beam() -> None:
    mass = 0.05
    parts = (Attached(0.43, mass=mass, inertia=mass * 0.004**2, stiffness=3e4),)
    bar = replace(BAR, attached=parts).real_modes(5)[0] / BAR.real_modes(5)[0]
    beam = replace(BEAM, attached=parts).real_modes(5)[0] / BEAM.real_modes(5)[0]
    np.testing.assert_allclose(bar, beam, atol=1e-3)
    soft = replace(BAR, clamp_rotation=2000.0).real_modes(4)[0]
    np.testing.assert_allclose(soft, replace(BEAM, clamp_rotation=2000.0).real_modes(4)[0], rtol=0.015)


@needs_ccx
def test_slot_costs_more_than_the_section_that_is_left() -> None:
    """Stress does not turn at right angles: the slot's neighbourhood is idle too, up to a depth or so away."""
    slot = replace(BAR, cuts=(Cut(0.15, 0.003, 0.004),)).real_modes(3)[0] / BAR.real_modes(3)[0] - 1
    least, most = (
        replace(BEAM, stretches=(Stretch(0.15, width, bending=0.125, line=0.5),)).real_modes(3)[0]
        / BEAM.real_modes(3)[0]
        - 1
        for width in (0.003, 0.003 + 2 * 0.004)
    )
    assert np.all(slot < 1.3 * least)
    assert np.all(slot > most)


@needs_ccx
def test_free_bar_on_springs() -> None:
    springs = tuple(Attached(x, stiffness=500.0) for x in (0.112, 0.388))
    bar, beam = (replace(b, clamped=(), attached=springs).real_modes(5)[0] for b in (BAR, BEAM))
    np.testing.assert_allclose(bar, beam, rtol=1.5e-3)
    with pytest.raises(StudyError, match="attach springs"):
        replace(BAR, clamped=()).real_modes(5)


@pytest.mark.long
@needs_ccx
def test_solid_plate_is_the_thick_plate() -> None:
    corner = (PlateAttached(0.376, 0.2, mass=0.02, inertia=0.02 * 0.0016**2),)
    solid = Solid(0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0, kind="plate", attached=corner)
    plate = Plate(0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0, attached=corner)
    places = np.array([[0.1, 0.02], [0.2, 0.13], [0.376, 0.0]])
    ours, theirs = (
        complex_modes(replace(b, alpha=2.0, beta=1e-6), places, places[2], count=8, scatter=np.ones(8))
        for b in (solid, plate)
    )
    np.testing.assert_allclose(ours.frequency, theirs.frequency, rtol=2e-3)
    np.testing.assert_allclose(ours.damping, theirs.damping, rtol=2e-3)
    size = np.abs(theirs.residues).max()
    assert np.abs(np.abs(ours.residues) - np.abs(theirs.residues)).max() < 0.02 * size
    assert ours.slopes.shape == theirs.slopes.shape


SOLIDS = DrawRanges(kinds=("solid",))


@needs_ccx
@pytest.mark.parametrize(
    "name", ["none", *(n for n, hidden_effect in HIDDEN_EFFECTS.items() if hidden_effect.solid)]
)
def test_trial_hides_an_effect_in_bricks(name: str) -> None:
    trial = draw_trial(7, 0, plan=replace(SOLIDS, effects=(name,), strong=0.0, mild=0.0))
    truth, body = trial.truth, trial.scene.body
    assert isinstance(body, Solid) and isinstance(trial.before.body, Solid)
    assert truth.kind == "solid" and truth.size == (trial.scene.setup.length,)
    assert truth.effects == (() if name == "none" else (name,))
    assert truth.visibility == 0.0 if name == "none" else truth.visibility > 1.0
    assert all(0 <= x <= truth.size[0] for (x,) in truth.places)


@pytest.mark.long
@needs_ccx
def test_trials_of_all_sorts_are_drawn() -> None:
    trials = [
        draw_trial(3, index, plan=replace(SOLIDS, none=0.3, pairs=0.3, outside=0.2)) for index in range(16)
    ]
    assert {len(trial.truth.effects) for trial in trials} == {0, 1, 2}
    assert not all(trial.truth.in_library for trial in trials)
    assert all(HIDDEN_EFFECTS[name].solid for trial in trials for name in trial.truth.effects)


@needs_ccx
def test_others_do_not_fit() -> None:
    setup = draw_setup(np.random.default_rng(1), plan=SOLIDS)
    unfit = [name for name, hidden_effect in HIDDEN_EFFECTS.items() if not hidden_effect.fits(setup)]
    assert {"axial_load", "fluid_added_mass", "clamp_rotation", "damping_patch", "shear"} <= set(unfit)


@needs_ccx
def test_nominal_model_is_a_beam_that_clamps_less() -> None:
    """A solid clamp also keeps the section from narrowing; that is all the gap of bricks made to the drawing."""
    setup = draw_setup(np.random.default_rng(5), plan=SOLIDS)
    nominal = nominal_scene(setup)
    assert isinstance(nominal.body, Beam)
    made = replace(nominal, body=replace(setup.made, attached=nominal.body.attached))  # type: ignore[type-var]
    ratio = made.elastic().frequency[: setup.modes] / nominal.elastic().frequency[: setup.modes]
    assert np.all((ratio > 1.0) & (ratio < 1.01))
    assert gap_percent(made) == pytest.approx(100 * np.sqrt(np.mean((1 / ratio - 1) ** 2)), rel=1e-6)


@needs_ccx
def test_study_of_a_solid_is_a_beams(tmp_path: Path) -> None:
    trial = draw_trial(2, 1, plan=replace(SOLIDS, effects=("local_stiffness",)))
    text = write_trial(trial, tmp_path).read_text()
    study = read_study(tmp_path / "study.toml")
    assert study is not None
    assert 'type = "beam"' in text and 'theory = "timoshenko"' in text and 'clamped = ["x0"]' in text
    assert "solid" not in text


@needs_ccx
def test_right_answer_closes_the_gap() -> None:
    trial = draw_trial(7, 0, plan=replace(SOLIDS, effects=("E",), mild=0.0))
    factor = trial.truth.parameters["E.factor"]
    row = Row(frozenset({"E"}), 0.97, parameters={"E.factor": Estimate(factor)})
    shrinkage = true_shrinkage(trial, Answer("named", (row.effects,), (row,)))
    assert shrinkage is not None
    assert shrinkage.after_percent < 0.1 * shrinkage.before_percent
    assert shrinkage.beyond_after_percent < 0.2 * shrinkage.beyond_before_percent


@pytest.mark.long
@needs_ccx
def test_solids_are_drawn_as_often_as_plates() -> None:
    rng = np.random.default_rng(3)
    kinds = Counter(
        draw_setup(rng, plan=DrawRanges(kinds=("beam", "plate", "solid"), plates=0.15)).kind
        for _ in range(60)
    )
    assert min(kinds["plate"], kinds["solid"]) > 2 and kinds["beam"] > 25
    kinds = Counter(draw_setup(rng, plan=DrawRanges(kinds=("plate", "solid"))).kind for _ in range(15))
    assert set(kinds) == {"plate", "solid"}


def test_solids_are_refused_without_calculix(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(StudyError, match=r"bodies of bricks .solid. need CalculiX.*install calculix-ccx"):
        draw_setup(np.random.default_rng(0), plan=DrawRanges(kinds=("beam", "solid")))


def test_exponents_of_three_digits_are_read() -> None:
    table = (
        "\n      1   4.0   2.0   0.3   0.0\n\n displacements (vx,vy,vz) for set READ\n\n"
        "         1 -1.572996-128  2.000000E-01 -1.000000+100\n\n"
    )
    omega, moved = solid_deck.printed(table, np.array([1]))
    np.testing.assert_array_equal(omega, [2.0])
    np.testing.assert_array_equal(moved, [[[-1.572996e-128, 0.2, -1e100]]])


def test_a_solid_without_calculix_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    assert not available()
    with pytest.raises(StudyError, match="install calculix-ccx"):
        solid_deck.run("", read=np.array([1]))
