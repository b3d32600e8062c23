"""The score, on outcomes whose counts are known by hand."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from acquisition.errors import InputError
from modalkit.blind.answer import read_answer
from modalkit.blind.run import BlindResult, Outcome
from modalkit.blind.scoring.rows import holds_truth, is_right, top_is_right
from modalkit.blind.scoring.score import score, wilson
from modalkit.blind.seal import seal
from modalkit.blind.trial import Truth


def diagnosis(verdict: str, *sets: tuple[str, ...], **more: Any) -> dict[str, Any]:
    shares = [2.0 ** -(i + 1) for i in range(len(sets))]
    rows = [
        {"effects": list(s), "probability": p, "equivalents": [], "parameters": {}, "plausible": True}
        for s, p in zip(sets, shares, strict=True)
    ]
    if rows and "parameters" in more:
        rows[0]["parameters"] = more["parameters"]
    return {
        "schema": "modalkit.diagnosis/1",
        "where": {"location": None, "locations": more.get("locations", [])},
        "cause": {"verdict": verdict, "sets": [list(s) for s in sets], "ranking": rows},
        "shrink": {"closed_percent": None},
    }


def truth(effect: str, *, visibility: float = 10.0, **parameters: float) -> Truth:
    withheld = effect in ("ground_spring", "taper")
    also = {"sensor_mass": ("lumped_mass",)}.get(effect, ())
    return Truth(
        effect=effect,
        parameters={f"{effect}.{k}": v for k, v in parameters.items()},
        accepted=() if withheld or effect == "none" else (effect, *also),
        in_library=not withheld,
        level="none" if effect == "none" else "clear",
        visibility=0.0 if effect == "none" else visibility,
        length=0.5,
    )


def run_of(*pairs: tuple[Truth, dict[str, Any] | None]) -> BlindResult:
    outcomes = [
        Outcome(
            index=i,
            truth=t,
            answer=None if d is None else read_answer(d),
            failure="EstimationError: broken" if d is None else None,
            sealed=seal(t.to_json()),
            seconds=0.1,
        )
        for i, (t, d) in enumerate(pairs)
    ]
    return BlindResult(7, tuple(outcomes))


@pytest.mark.parametrize(
    ("effect", "said", "right", "top"),
    [
        ("E", diagnosis("named", ("E",)), True, True),
        ("E", diagnosis("named", ("density",)), False, False),
        ("E", diagnosis("class", ("density",), ("E",)), True, False),
        ("E", diagnosis("named", ("E", "length")), False, False),
        ("E", diagnosis("none"), False, False),
        ("E", diagnosis("unknown", ("E",)), False, False),
        ("sensor_mass", diagnosis("named", ("lumped_mass",)), True, True),
        ("none", diagnosis("none", ("E",)), True, True),
        ("none", diagnosis("unknown"), False, False),
        ("taper", diagnosis("unknown", ("E",)), True, True),
        ("taper", diagnosis("named", ("thickness",)), False, False),
    ],
)
def test_judgement(effect: str, said: dict[str, Any], right: bool, top: bool) -> None:
    answer = read_answer(said)
    assert is_right(answer, truth(effect)) == right
    assert top_is_right(answer, truth(effect)) == top


def test_pair_that_contains_the_truth_does_not_hold_it() -> None:
    pair = read_answer(diagnosis("class", ("E", "length"), ("thickness", "length")))
    assert not holds_truth(pair, truth("E"))


def test_rates_are_counted_as_by_hand() -> None:
    factor = {"E.factor": {"value": 1.1, "unit": "-", "low95": 1.05, "high95": 1.15, "at_bound": False}}
    result = score(
        run_of(
            (truth("E", factor=1.12), diagnosis("named", ("E",), parameters=factor)),
            (truth("E", factor=1.30), diagnosis("named", ("E",), parameters=factor)),
            (truth("E"), diagnosis("class", ("density",), ("E",))),
            (truth("density"), diagnosis("named", ("E",))),
            (truth("density", visibility=1.0), diagnosis("none")),
            (truth("length"), diagnosis("class", ("E",), ("density",))),
            (truth("length"), None),
            (truth("none"), diagnosis("none")),
            (truth("none"), diagnosis("named", ("E",))),
            (truth("taper"), diagnosis("unknown")),
            (truth("ground_spring"), diagnosis("named", ("clamp_rotation",))),
        )
    )
    counts = {q: (int(r["count"]), int(r["total"])) for q, r in result.rates.iterrows()}
    assert counts == {
        "most probable answer is the truth": (3, 8),
        "answer is true (named, in the class, or none)": (4, 8),
        "commits to a name": (3, 6),
        "right when it commits": (2, 5),
        "right when it commits, effect of the library": (2, 3),
        "class holds the truth": (1, 2),
        "right when it names or gives a class": (3, 5),
        "visible effect called none": (0, 6),
        "visible effect called unknown": (0, 6),
        "faint effect: true answer or none": (1, 1),
        "false alarm on none": (1, 2),
        "withheld effect called unknown": (1, 2),
        "withheld effect given a wrong name": (1, 2),
        "severity inside its 95 % interval": (1, 2),
        "diagnosis failed": (1, 11),
    }
    assert result.confusion.loc["length", "failed"] == 1
    assert result.confusion.loc["E", "class with it"] == 1
    assert result.confusion.to_numpy().sum() == 11
    assert result.effects.loc["E", "mean class size"] == pytest.approx(4 / 3)
    assert result.effects["trials"].sum() == 11


def test_places_take_the_nearest_of_mirrored_ones() -> None:
    said = diagnosis("named", ("local_stiffness",), locations=[[0.4, 0, 0], [0.11, 0, 0]])
    table = score(run_of((truth("local_stiffness", x=0.1), said))).places
    assert table["error"].tolist() == pytest.approx([0.01 / 0.5])
    assert table["places"].tolist() == [2]


def test_json_is_strict_and_whole() -> None:
    result = score(run_of((truth("none"), diagnosis("none")), (truth("E", factor=1.1), None)))
    text = json.dumps(result.to_json(), allow_nan=False)
    back = json.loads(text)
    assert back["schema"] == "modalkit.blind/1"
    assert back["confusion"] == {"E": {"failed": 1}, "none": {"none": 1}}
    assert [row["failure"] for row in back["trials"]] == ["", "EstimationError: broken"]
    assert len({row["salt"] for row in back["seals"]}) == 2


# Agresti and Coull, The American Statistician 52 (1998) 119: 0 of 10 and 5 of 10
def test_wilson_interval() -> None:
    assert wilson(0, 10) == pytest.approx((0.0, 0.2775), abs=5e-4)
    assert wilson(5, 10) == pytest.approx((0.2366, 0.7634), abs=5e-4)
    assert all(math.isnan(bound) for bound in wilson(0, 0))


@pytest.mark.parametrize(
    "broken",
    [
        {},
        {"cause": {"verdict": "maybe", "sets": [], "ranking": []}, "where": {}, "shrink": {}},
        {"cause": {"verdict": "named", "sets": [["E"]], "ranking": [{"effects": ["E"]}]}, "where": {}},
    ],
)
def test_malformed_diagnosis_is_refused(broken: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="does not follow"):
        read_answer(broken)
