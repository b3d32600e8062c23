"""Both levels of an answer are scored: channel with place, and the story."""

from __future__ import annotations

import json
from typing import Any

import pytest
from blind_outcomes import diagnosis, run_of, truth

from modalkit.blind import score
from modalkit.blind.answer import read_answer
from modalkit.blind.scoring.levels import CERTAIN, LEADING, STORY, WRONG, WRONG_STORY, mechanism_is_right
from modalkit.blind.scoring.page import sections
from modalkit.blind.scoring.table import ALL

BODY = truth("lumped_mass", places=((0.2,),))


def stated(
    verdict: str, *sets: tuple[str, ...], level: str | None, at: float | None = 0.2, **more: Any
) -> dict[str, Any]:
    """A diagnosis with a mechanism: a mass at a place unless stated otherwise, known to 1 mm."""
    document = diagnosis(verdict, *sets)
    place = None if at is None else [at, 0.0, 0.0]
    leading = {
        "channel": "mass",
        "extent": "global" if at is None else "local",
        "location": place,
        "locations": [] if place is None else [place],
        "location_low95": None if at is None else [at - 1e-3, 0.0, 0.0],
        "location_high95": None if at is None else [at + 1e-3, 0.0, 0.0],
        "size": None,
        "probability": 0.97,
        "sets": [],
        **more,
    }
    document["cause"] |= {"level": level, "mechanism": leading}
    return document


@pytest.mark.parametrize(
    ("message", "right"),
    [
        (stated("named", ("lumped_mass",), level="story"), True),
        (stated("class", ("lumped_mass",), ("local_mass",), level="mechanism", at=0.21), True),
        (stated("unknown", level="mechanism", at=0.4), False),
        (stated("unknown", level="mechanism", at=0.3, location_low95=[0.1, 0, 0]), True),
        (stated("unknown", level="mechanism", channel="stiffness"), False),
        (stated("unknown", level=None, at=None), False),
    ],
)
def test_a_mechanism_is_right_in_channel_and_place(message: dict[str, Any], right: bool) -> None:
    leading = read_answer(message).mechanism
    assert leading is not None
    assert mechanism_is_right(leading, BODY) == right


def test_what_is_everywhere_is_not_called_local_and_the_measurement_needs_no_place() -> None:
    here = read_answer(stated("named", ("E",), level="story", channel="stiffness")).mechanism
    everywhere = read_answer(stated("named", ("E",), level="story", channel="stiffness", at=None)).mechanism
    chain = read_answer(
        stated("unknown", level=None, channel="measurement", extent="chain", at=None)
    ).mechanism
    assert here is not None and everywhere is not None and chain is not None
    assert not mechanism_is_right(here, truth("E"))
    assert mechanism_is_right(everywhere, truth("E"))
    assert mechanism_is_right(chain, truth("polarity", places=((0.1,),)))


def test_levels_are_counted_beside_each_other() -> None:
    """A right story; a right mechanism; a wrong story, whose mechanism is right; an unknown with a wrong place."""
    other = stated("named", ("local_mass",), level="story")
    run = run_of(
        (BODY, stated("named", ("lumped_mass",), level="story")),
        (BODY, stated("class", ("lumped_mass",), ("local_mass",), level="mechanism")),
        (BODY, other),
        (BODY, stated("unknown", level="mechanism", at=0.4)),
        (BODY, diagnosis("named", ("lumped_mass",))),  # of a version that has no levels
        (truth(), stated("named", ("E",), level="story")),
    )
    found = score(run)
    counts = {q: found.rates[q, ALL].count for q in (LEADING, CERTAIN, WRONG, STORY, WRONG_STORY)}
    assert counts == {LEADING: 3, CERTAIN: 3, WRONG: 1, STORY: 1, WRONG_STORY: 1}
    assert found.rates[LEADING, ALL].total == 4
    assert any(section.title == "Mechanism and story" for section in sections(found))


def test_a_run_without_levels_has_no_table_of_them() -> None:
    found = score(run_of((BODY, diagnosis("named", ("lumped_mass",)))))
    assert not any(section.title == "Mechanism and story" for section in sections(found))


def test_levels_stay_in_the_short_document() -> None:
    answer = read_answer(stated("unknown", level="mechanism"))
    again = read_answer(json.loads(json.dumps(answer.to_json())))
    assert again.mechanism == answer.mechanism
    assert (again.level, again.has_levels) == ("mechanism", True)
    assert not read_answer(read_answer(diagnosis("none")).to_json()).has_levels
