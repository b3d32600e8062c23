"""A fixed sensor is spoken of by its node and direction, points of the end that roved by their nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, blank

from acquisition.errors import StudyError
from updating import LIBRARY, Predictor
from updating.effects import accepted_state

PLACES = np.linspace(0.05, 0.376, 7)


def predictor_of_sensors(*, roving: str = "hit") -> Predictor:
    """Seven points and two ends that stayed, at the first point and the fifth."""
    base = blank(PLACES)
    zero = np.zeros((14, 2))
    moved, stayed = np.tile(np.arange(7), 2), np.repeat([0, 4], 7)
    ends = {"hit": moved, "seen": stayed} if roving == "hit" else {"seen": moved, "hit": stayed}
    written = tuple(f"{node}+Z" for node in base.nodes)
    return Predictor(BEAM, replace(base, **ends, written=written, constants=zero, constants_sigma=zero + 1))


@pytest.mark.parametrize("name", ["5+Z", "5+z", "5"])
def test_a_sensor_and_the_hits_beside_it_are_two_things(name: str) -> None:
    evaluation = predictor_of_sensors()
    polarity = LIBRARY["polarity"]
    assert polarity.state(evaluation, {"channel": name}).point_gains == {("seen", 4): -1.0}
    assert polarity.state(evaluation, {"points": (5,)}).point_gains == {("hit", 4): -1.0}
    roved = predictor_of_sensors(roving="seen")
    assert polarity.state(roved, {"channel": name}).point_gains == {("hit", 4): -1.0}
    assert polarity.state(roved, {"points": (5,)}).point_gains == {("seen", 4): -1.0}


def test_the_forms_of_an_effect_can_be_stated_as_they_are_reported() -> None:
    evaluation = predictor_of_sensors()
    evaluation = evaluation.for_test(replace(evaluation.measured, constants=np.ones((14, 2))))
    for name, more in (("polarity", {}), ("channel_gain", {"gain": 0.9})):
        forms = [form.values for form in LIBRARY[name].variants(evaluation)]
        assert {"5+Z", "1+Z"} <= {values.get("channel") for values in forms}
        for values in forms:
            state = accepted_state(evaluation, name, {**values, **more})
            again = LIBRARY[name].state(evaluation, {**values, **more})
            assert (state.point_gains, state.gain) == (again.point_gains, again.gain)


def test_the_error_names_what_is_wrong() -> None:
    evaluation = predictor_of_sensors()
    with pytest.raises(StudyError, match=r"no sensor that stayed; the test has 1\+Z, 5\+Z"):
        accepted_state(evaluation, "polarity", {"channel": "3+Z"})
    with pytest.raises(StudyError, match=r"takes points \(or channel"):
        accepted_state(evaluation, "polarity", {})
    with pytest.raises(StudyError, match="found channel, points"):
        accepted_state(evaluation, "polarity", {"channel": "5+Z", "points": (5,)})


def test_the_sentence_names_the_sensor() -> None:
    assert "sensor 5+Z" in LIBRARY["polarity"].sentence({"channel": "5+Z"})
    assert "hit from the other side" in LIBRARY["polarity"].sentence({"points": (5,)})
    gain = LIBRARY["channel_gain"]
    assert "sensor 5+Z" in gain.sentence({"channel": "5+Z", "gain": 0.9})
    assert gain.sentence({"points": (5,), "gain": 0.9}) == gain.summary


def test_the_whole_chain_and_its_channels_are_two_effects() -> None:
    evaluation = predictor_of_sensors()
    assert accepted_state(evaluation, "calibration_gain", {"gain": 0.9}).gain == 0.9
    with pytest.raises(StudyError, match="takes gain, found channel, gain"):
        accepted_state(evaluation, "calibration_gain", {"gain": 0.9, "channel": "5+Z"})
    one = accepted_state(evaluation, "channel_gain", {"gain": 0.9, "channel": "5+Z"})
    assert (one.gain, dict(one.point_gains)) == (1.0, {("seen", 4): 0.9})
    two = accepted_state(evaluation, "channel_gain", {"gain": 1.2, "points": (3, 7)})
    assert dict(two.point_gains) == {("hit", 2): 1.2, ("hit", 6): 1.2}
