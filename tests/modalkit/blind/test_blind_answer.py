"""Reading a diagnosis for the score."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from blind_outcomes import diagnosis, interval

from acquisition.errors import InputError
from modalkit.blind.answer import read_answer


@pytest.mark.parametrize(
    "broken",
    [
        {},
        {"cause": {"verdict": "maybe", "sets": [], "ranking": []}, "where": {}, "shrink": {}},
        {"cause": {"verdict": "named", "sets": [["E"]], "ranking": [{"effects": ["E"]}]}, "where": {}},
        {
            "cause": {"verdict": "none", "sets": [], "ranking": []},
            "where": {"locations": [[0.1]]},
            "shrink": {},
        },
    ],
)
def test_malformed_diagnosis_is_refused(broken: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="does not follow"):
        read_answer(broken)


def test_rows_are_sorted_and_keep_their_own_parameters() -> None:
    message = diagnosis("class", ("E",), ("density",), shares=[0.3, 0.6])
    message["cause"]["ranking"][0]["parameters"] = {"E.factor": interval(1.2, 1.1, 1.3)}
    answer = read_answer(message)
    assert [row.effects for row in answer.ranking] == [{"density"}, {"E"}]
    row = answer.row(["E"])
    assert row is not None and row.parameters["E.factor"].high == 1.3
    assert answer.row(["length"]) is None
    assert answer.top == {"density"}


def test_top_is_empty_for_none_and_nothing_for_unknown() -> None:
    assert read_answer(diagnosis("none", others=[("E",)])).top == frozenset()
    assert read_answer(diagnosis("unknown", others=[("E",)])).top is None


def test_points_words_and_what_is_not_determined() -> None:
    parameters = {
        "polarity.points": {"value": [4, 2], "unit": "node", "low95": None, "high95": None},
        "position_error.point": {"value": 7, "unit": "node", "low95": None, "high95": None},
        "local_stiffness.region": {"value": "root", "unit": "", "low95": None, "high95": None},
        "E.factor": {"value": None, "unit": "-", "low95": None, "high95": None},
    }
    row = read_answer(diagnosis("named", ("polarity",), parameters=parameters)).ranking[0]
    assert row.points == {"polarity.points": (4, 2), "position_error.point": (7,)}
    assert list(row.parameters) == ["E.factor"] and math.isnan(row.parameters["E.factor"].value)


def test_answer_goes_through_json_unchanged() -> None:
    message = diagnosis(
        "class",
        ("E",),
        ("polarity",),
        parameters={"E.factor": interval(1.2, 1.1, 1.3)},
        locations=[[0.1, 0.2, 0.0]],
        closed=interval(90, 80, 99),
        channel="stiffness",
    )
    first = read_answer(message).to_json()
    text = json.dumps(first, allow_nan=False)
    again = read_answer(json.loads(text))
    assert again.to_json() == first
    assert again.locations == ((0.1, 0.2),)
    assert again.closed is not None and again.closed.low == 80
    assert again.held_out == {"before_percent": 5.0, "after_percent": 0.5, "noise_floor_percent": 0.1}
