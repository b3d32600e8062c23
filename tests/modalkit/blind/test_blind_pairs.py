"""Two effects at once."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from modalkit.blind.scoring.trials import is_visible
from modalkit.blind.trial import draw_trial
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.drawing.specimen import draw_setup, lacks_shear
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.hidden.choose import choose_hidden_effects, right_answers

PAIRS = DrawRanges(kinds=("beam",), none=0.0, outside=0.0, pairs=1.0)


@pytest.fixture(scope="module")
def chosen() -> list[tuple[str, ...]]:
    """Pairs that are drawn on many setups."""
    rng = np.random.default_rng(4)
    found = []
    for _ in range(1500):
        pair = choose_hidden_effects(rng, draw_setup(rng, plan=PAIRS), "pair", PAIRS)
        assert pair is not None
        found.append(tuple(hidden_effect.name for hidden_effect in pair))
    return found


@pytest.mark.long
def test_pairs_are_two_of_the_library_in_the_order_in_which_they_act(chosen: list[tuple[str, ...]]) -> None:
    order = list(HIDDEN_EFFECTS)
    for pair in chosen:
        assert len(set(pair)) == 2
        assert all(HIDDEN_EFFECTS[name].in_library for name in pair)
        assert order.index(pair[0]) < order.index(pair[1])


def test_what_cannot_be_together_is_not_drawn(chosen: list[tuple[str, ...]]) -> None:
    for first, second in chosen:
        exclusives = HIDDEN_EFFECTS[first].exclusive, HIDDEN_EFFECTS[second].exclusive
        assert "" in exclusives or exclusives[0] != exclusives[1]
    never = {("section_scale", "calibration_gain"), ("uniform_damping", "exponential_window")}
    assert never.isdisjoint(chosen)


def test_pairs_come_from_all_that_physics_allows(chosen: list[tuple[str, ...]]) -> None:
    counts = Counter(chosen)
    assert len(counts) > 200
    assert counts.most_common(1)[0][1] < 25
    assert {name for pair in chosen for name in pair} == {
        name
        for name, hidden_effect in HIDDEN_EFFECTS.items()
        if not hidden_effect.outside and name != "orthotropy"
    }


def test_both_act_and_both_are_told() -> None:
    for index in range(6):
        trial = draw_trial(7, index, plan=PAIRS)
        truth, setup = trial.truth, trial.scene.setup
        assert len(truth.effects) == 2
        stated = {name.split(".")[0] for name in truth.parameters}
        assert stated == set(truth.effects) - {"shear"}
        assert tuple(sorted(truth.effects)) in truth.accepted
        assert all(tuple(sorted(names)) == names and len(names) == 2 for names in truth.accepted)
        assert lacks_shear(setup) == ("shear" in truth.effects)
        assert truth.visibility > 0


def test_equals_multiply_and_never_merge() -> None:
    setup = replace(draw_trial(1, 0, plan=PAIRS).scene.setup, sensor_mass=0.0)
    hidden_effects = [HIDDEN_EFFECTS["sensor_mass"], HIDDEN_EFFECTS["calibration_gain"]]
    sets = right_answers(hidden_effects, [{"mass": 0.01}, {"gain": 1.2}], setup)
    assert set(sets) == {
        ("calibration_gain", "sensor_mass"),
        ("calibration_gain", "lumped_mass"),
        ("section_scale", "sensor_mass"),
        ("lumped_mass", "section_scale"),
    }
    left = right_answers(
        hidden_effects, [{"mass": 0.01}, {"gain": 1.2}], setup, ["sensor_mass", "calibration_gain"]
    )
    assert left == (("lumped_mass", "section_scale"),)
    at = setup.points[setup.sensor][0]
    twice = [HIDDEN_EFFECTS["sensor_mass"], HIDDEN_EFFECTS["lumped_mass"]]
    merged = right_answers(twice, [{"mass": 0.01}, {"mass": 0.02, "x": at}], setup)
    assert merged == (("lumped_mass", "sensor_mass"),)


def test_named_effects_are_paired_among_themselves() -> None:
    plan = replace(PAIRS, effects=("E", "lumped_mass", "polarity", "taper"))
    for index in range(5):
        assert set(draw_trial(3, index, plan=plan).truth.effects) < {"E", "lumped_mass", "polarity"}


def test_each_of_two_is_counted_by_what_it_adds_to_the_other() -> None:
    """What one cause hides of the other is no answer that the data could give."""
    for index in range(4):
        truth = draw_trial(5, index, plan=PAIRS).truth
        assert len(truth.beside) == 2
        # one of them moved nothing beside the other: the whole is the other, up to what noise changes
        assert truth.visibility > 0.3 * max(truth.beside)
    assert is_visible(replace(truth, visibility=9.0, beside=(8.0, 4.0)))
    assert not is_visible(replace(truth, visibility=9.0, beside=(8.0, 1.0)))
    assert draw_trial(5, 0, plan=replace(PAIRS, pairs=0.0)).truth.beside == ()
