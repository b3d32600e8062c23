"""What is drawn, what is stated of it, and that the two have nothing to do with each other."""

from __future__ import annotations

import json
import tomllib
from collections import Counter
from dataclasses import asdict, fields, replace

import numpy as np
import pytest
import scipy.stats

from acquisition.errors import StudyError
from modalkit.blind.trial import Trial, Truth, draw_trial
from modalkit.simulator.drawing.ranges import KINDS, DrawRanges
from modalkit.simulator.drawing.specimen import _draw_kind, draw_setup, lacks_shear
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.hidden.choose import choose_hidden_effects, choose_sort, draw_strength
from modalkit.simulator.scene import draw_scene, nominal_scene
from modalkit.simulator.setup import Setup
from modalkit.simulator.study_file import study_text

BEAMS = DrawRanges(kinds=("beam",))


def hide(name: str, index: int = 0, seed: int = 8) -> Trial:
    return draw_trial(seed, index, plan=replace(BEAMS, effects=(name,)))


def test_trials_repeat_and_differ() -> None:
    one, same, other, seed = (draw_trial(s, i, plan=BEAMS) for s, i in ((1, 4), (1, 4), (1, 5), (2, 4)))
    assert one.truth == same.truth
    assert one.scene.setup == same.scene.setup
    assert one.scene.setup not in (other.scene.setup, seed.scene.setup)


@pytest.mark.long
def test_truth_survives_json() -> None:
    for index in range(12):
        truth = draw_trial(3, index, plan=replace(BEAMS, leave_out=index % 2 == 0)).truth
        assert Truth.from_json(json.loads(json.dumps(truth.to_json(), allow_nan=False))) == truth


def test_plan_survives_json_and_is_checked() -> None:
    plan = DrawRanges(kinds=("beam",), effects=("E", "rib"), none=0.3, leave_out=True)
    assert DrawRanges.from_json(json.loads(json.dumps(plan.to_json()))) == plan
    with pytest.raises(StudyError, match=r"kinds.*shell"):
        DrawRanges(kinds=("shell",))
    with pytest.raises(StudyError, match=r"pairs = 1\.2"):
        DrawRanges(pairs=1.2)
    with pytest.raises(StudyError, match="more than 1"):
        DrawRanges(mild=0.7, strong=0.7)


def test_unknown_effect_is_refused() -> None:
    with pytest.raises(StudyError, match=r"cannot hide gravity.*taper"):
        hide("gravity")


def test_nothing_hidden() -> None:
    trial = hide("none")
    assert not any((trial.truth.effects, trial.truth.accepted, trial.truth.places))
    assert (trial.truth.level, trial.truth.severity, trial.truth.visibility) == ("none", 0.0, 0.0)
    assert trial.scene is trial.before
    assert trial.truth.in_library


def test_shares_of_sorts_and_strengths_are_the_plans() -> None:
    rng, plan, count = np.random.default_rng(1), DrawRanges(), 4000
    sorts = Counter(choose_sort(rng, plan) for _ in range(count))
    levels = Counter(draw_strength(rng, plan)[0] for _ in range(count))
    for found, share in (
        (sorts["none"], plan.none),
        (sorts["pair"], plan.pairs),
        (sorts["outside"], plan.outside),
        (levels["mild"], plan.mild),
        (levels["strong"], plan.strong),
    ):
        assert scipy.stats.binomtest(found, count, share).pvalue > 1e-4


@pytest.fixture(scope="module")
def draws() -> list[tuple[Setup, str]]:
    """Setups with the single effect that was chosen for each, as trials draw them."""
    rng, plan = np.random.default_rng(12), replace(BEAMS, pairs=0.0, none=0.0, outside=0.0)
    found = []
    for _ in range(2500):
        setup = draw_setup(rng, plan=plan)
        chosen = choose_hidden_effects(rng, setup, "single", plan)
        assert chosen is not None
        found.append((setup, chosen[0].name))
    return found


@pytest.mark.long
def test_every_effect_comes_up_about_as_often(draws: list[tuple[Setup, str]]) -> None:
    counts = Counter(name for _, name in draws)
    inside = [
        name
        for name, hidden_effect in HIDDEN_EFFECTS.items()
        if not hidden_effect.outside and hidden_effect.applies(draws[0][0])
    ]
    assert set(inside) <= set(counts)
    mean = len(draws) / len(counts)
    assert all(0.5 * mean < count < 1.7 * mean for count in counts.values())


def test_the_setup_does_not_tell_the_effect(draws: list[tuple[Setup, str]]) -> None:
    """Among effects that any specimen can have, nothing that the study states depends on which it is."""
    anywhere = [
        *("E", "density", "thickness", "sensor_mass", "lumped_mass", "local_stiffness", "damping_patch"),
        *("fluid_added_mass", "fluid_damping", "uniform_damping", "exponential_window"),
        *("time_delay", "polarity", "swapped_points", "position_error"),
    ]
    chosen = [(s, anywhere.index(name)) for s, name in draws if name in anywhere and not lacks_shear(s)]
    effect = np.array([i for _, i in chosen])
    for field in fields(Setup):
        stated = [getattr(s, field.name) for s, _ in chosen]
        if isinstance(stated[0], float):
            groups = [np.array(stated)[effect == i] for i in range(len(anywhere))]
            if len(set(stated)) > 10:
                assert scipy.stats.kruskal(*groups).pvalue > 1e-4, field.name
                continue
        if field.name in ("title", "tolerances", "points"):
            continue
        keys = {key: k for k, key in enumerate(sorted({repr(v) for v in stated}))}
        if 1 < len(keys) <= 10:
            table = np.zeros((len(anywhere), len(keys)))
            np.add.at(table, (effect, np.array([keys[repr(v)] for v in stated])), 1)
            assert scipy.stats.chi2_contingency(table).pvalue > 1e-4, field.name


def test_a_slender_theory_stands_only_where_it_fits_or_shear_is_hidden() -> None:
    rng = np.random.default_rng(2)
    setups = [draw_setup(rng, plan=BEAMS) for _ in range(300)]
    slender = [s for s in setups if s.theory == "euler-bernoulli"]
    assert slender
    assert all(s.shear_shift < s.repeatability or (lacks_shear(s) and not s.baseline) for s in slender)
    for index in range(3):
        setup = hide("shear", index).scene.setup
        assert lacks_shear(setup) and not setup.baseline
    for setup in filter(lacks_shear, setups):
        for sort in ("single", "pair"):
            chosen = choose_hidden_effects(rng, setup, sort, BEAMS)
            assert chosen is not None and "shear" in [s.name for s in chosen]


def test_specimens_scatter_by_the_stated_tolerances() -> None:
    setup = replace(hide("none", seed=6).scene.setup, calibration=0.02)
    rng = np.random.default_rng(1)
    scenes = [draw_scene(setup, rng) for _ in range(400)]
    names = ("E", "density", "thickness", "length")
    drawn = np.array([[*(getattr(s.body, name) for name in names), s.chain.gain] for s in scenes])
    nominal = [setup.E, setup.density, setup.thickness, setup.length, 1.0]
    assert (drawn / nominal).std(axis=0) == pytest.approx([0.01, 0.003, 0.005, 0.002, 0.02], rel=0.15)
    assert (drawn / nominal).mean(axis=0) == pytest.approx(np.ones(5), abs=0.004)
    marks = np.array([s.marks for s in scenes])
    assert marks.std() == pytest.approx(0.8 * setup.position_sigma, rel=0.05)


@pytest.mark.parametrize("index", range(6))
def test_study_states_the_setup_and_nothing_else(index: int) -> None:
    trial = draw_trial(5, index, plan=BEAMS)
    setup = trial.scene.setup
    text = study_text(setup, test_file="test.uff", baseline_file="baseline.uff")
    study = tomllib.loads(text)
    assert study["model"]["material"] == {"E": setup.E, "density": setup.density, "poisson": setup.poisson}
    assert study["model"]["length"] == setup.length
    assert study["model"]["clamped"] == list(setup.clamped)
    assert study["model"]["elements"] == setup.elements[0]
    assert study["tolerances"] == asdict(setup.tolerances)
    assert study["test"]["band"] == list(setup.band)
    assert study["test"]["calibration"] == setup.calibration
    assert ("baseline" in study) == setup.baseline
    assert ("environment" in study) == (setup.environment is not None)
    given = [] if not setup.sensor_mass else [list(setup.points[setup.sensor])]
    assert [mass["at"] for mass in study["model"].get("mass", [])] == given
    words = ("bad", "peak", "hits", *(name for name in trial.truth.effects if name != "density"))
    assert not any(word in text for word in words if word not in ("E", "thickness", "length"))
    assert set(study["model"]) <= {
        *("type", "length", "width", "thickness", "elements", "clamped", "theory"),
        *("material", "damping", "mass"),
    }


def test_band_holds_the_modes_it_was_chosen_for() -> None:
    for index in range(8):
        setup = draw_trial(30, index, plan=BEAMS).scene.setup
        hz = np.array(setup.nominal_hz)
        low, high = setup.band
        assert low < hz[0] and hz[setup.modes - 1] < high
        assert hz[0] >= 5.0 and high <= 6000.0


def test_leaving_out_takes_the_true_effect_away() -> None:
    plan = replace(BEAMS, leave_out=True, pairs=0.0)
    gain = draw_trial(2, 0, plan=replace(plan, effects=("calibration_gain",))).truth
    assert gain.without == ("calibration_gain",)
    assert gain.accepted in ((("section_scale",),), ())
    stiff = draw_trial(2, 0, plan=replace(plan, effects=("E",))).truth
    assert (stiff.without, stiff.accepted) == (("E",), ())
    rib = draw_trial(2, 0, plan=replace(plan, effects=("rib",))).truth
    assert (rib.without, rib.accepted, rib.in_library) == ((), (), False)


PLATES = DrawRanges(kinds=("plate",))


@pytest.mark.parametrize("kinds", [KINDS, KINDS[:2], KINDS[:4], KINDS[1:]])
def test_every_kind_that_is_asked_for_is_drawn(kinds: tuple[str, ...]) -> None:
    rng, plan = np.random.default_rng(3), DrawRanges(kinds=kinds)
    counts = Counter(_draw_kind(rng, plan) for _ in range(2000))
    assert set(counts) == set(kinds)
    assert min(counts.values()) > 0.8 * 2000 / max(len(kinds), 3)


@pytest.mark.long
def test_plates_are_drawn_as_often_as_said() -> None:
    rng = np.random.default_rng(3)
    kinds = Counter(draw_setup(rng, plan=DrawRanges(plates=0.3)).kind for _ in range(120))
    assert scipy.stats.binomtest(kinds["plate"], 120, 0.3).pvalue > 1e-4


@pytest.fixture(scope="module")
def plates() -> list[Trial]:
    return [draw_trial(14, index, plan=PLATES) for index in range(4)]


@pytest.mark.long
@pytest.mark.parametrize("index", range(4))
def test_plates_are_stated_thin_and_hit_inside(plates: list[Trial], index: int) -> None:
    trial = plates[index]
    setup = trial.scene.setup
    study = tomllib.loads(study_text(setup, test_file="a.uff", baseline_file="b.uff"))
    assert study["model"]["type"] == trial.truth.kind == "plate"
    assert study["model"]["elements"] == list(setup.elements)
    assert study["model"]["theory"] == "kirchhoff"
    assert trial.truth.size == (setup.length, setup.width)
    assert setup.shear_shift < 0.8 * setup.repeatability
    assert np.all((setup.places >= 0) & (setup.places <= np.array(setup.size) + 1e-9))
    shapes = np.abs(trial.before.elastic().points).max(axis=1)
    assert shapes.min() > 1e-4 * shapes.max()


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("E", {"factor": 1.21}),
        ("orthotropy", {"ratio": 1.3}),
        ("lumped_mass", {"mass": 0.05, "x": 0.2, "y": 0.1}),
        ("ground_spring", {"stiffness": 500.0, "x": 0.2, "y": 0.1}),
        ("local_stiffness", {"x": 0.1, "y": 0.1, "extent": 0.05, "loss": 0.8}),
        ("skew_clamp", {"angle": 0.1}),
        ("fluid_added_mass", {"fluid_density": 998.0}),
    ],
)
def test_plates_move_the_way_they_must(plates: list[Trial], name: str, values: dict[str, float]) -> None:
    setup = next(trial.scene.setup for trial in plates if "x0" in trial.scene.setup.clamped)
    setup = replace(setup, sensor_mass=0.0)
    before = nominal_scene(setup)
    after = HIDDEN_EFFECTS[name].act(before, values)
    moved = after.elastic().frequency[: setup.modes] / before.elastic().frequency[: setup.modes] - 1
    if name == "E":
        np.testing.assert_allclose(moved, 0.1, rtol=1e-4)
    elif name in ("orthotropy", "ground_spring"):
        assert moved.max() > 1e-4 and moved.min() > -2e-3
    elif name == "skew_clamp":
        assert 1e-5 < np.abs(moved).max() < 0.1
    else:
        assert moved.max() < 1e-6 and moved.min() < -1e-4
