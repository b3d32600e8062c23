"""What of a diagnosis can be accepted, and what acceptance does to the study."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from opening import opened

from acquisition import ModalData, read_uff, write_uff
from acquisition.errors import InputError
from modalkit.app.acceptance import exchanged_points, offer
from modalkit.app.export import study_text
from modalkit.output.whole import plain, write_text
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked


def ranked(*effects: str, **values: float | str | tuple[int, ...]) -> Ranked:
    """Return a row of a diagnosis."""
    estimates = {
        name: ParameterEstimate(value, "", None, None, at_bound=False) for name, value in values.items()
    }
    return Ranked(
        effects=effects,
        probability=0.5,
        equivalents=(),
        parameters=estimates,
        plausible=True,
        p_value=0.5,
        forms=(),
    )


def test_a_row_is_offered_only_if_the_study_takes_it(beam: Path) -> None:
    controller = opened(beam)
    predictor = controller._workbench.predictor(controller.study)
    good = ranked("sensor_mass", **{"sensor_mass.mass": 0.008})
    assert offer(good, predictor).entries == [{"name": "sensor_mass", "mass": 0.008}]
    assert offer(ranked(), predictor).entries is None
    assert "hypothesis" in offer(ranked("joint 3 is loose"), predictor).why_not
    twice = ranked("E", **{"E.factor": 1.1})
    assert offer(twice, predictor).entries == [{"name": "E", "factor": 1.1}]
    assert "only once" in offer(twice, predictor, ["E"]).why_not
    pointless = offer(ranked("swapped_points"), predictor)
    assert pointless.entries is None
    assert "points" in pointless.why_not


@pytest.fixture
def swapped(beam: Path) -> Path:
    """Return the study of a beam at which two labels were exchanged."""
    path = beam.parent / "beam_dry.uff"
    (test,) = read_uff(path).tests
    a, b = test.points[1].reference, test.points[3].reference
    labels = {a: b, b: a}
    points = tuple(replace(p, reference=labels.get(p.reference, p.reference)) for p in test.points)
    write_uff(path, tests=[replace(test, points=points)], geometry=test.geometry)
    return beam


def diagnosed(controller, rows: list[dict]) -> None:
    """Write what a diagnosis of the state would have left."""
    folder = controller._folder("diagnose")
    write_text(folder / "result.json", json.dumps({"rows": rows, "document": {"warnings": []}}))


def test_exchanged_labels_are_accepted_by_exchanging_the_places(swapped: Path) -> None:
    controller = opened(swapped)
    before = plain(controller.model())["correlation"]["pairs"]
    controller._folder("diagnose").mkdir(parents=True)
    entries = [{"name": "swapped_points", "points": [4, 2]}, {"name": "sensor_mass", "mass": 0.008}]
    diagnosed(controller, [{"entries": entries, "why_not": ""}, {"entries": None, "why_not": "no place"}])
    state = controller.accept(0)
    assert state["accepted"] == ["sensor mass, places of points 4 and 2 exchanged"]
    assert state["undo"].startswith("accept sensor mass")
    after = plain(controller.model())["correlation"]["pairs"]
    assert min(p["mac"] for p in after) > 0.98 > min((p["mac"] for p in before), default=0.0)
    assert controller.study.model.effect == [{"name": "sensor_mass", "mass": 0.008}]
    x = {n: place[0] for n, place in zip(*[controller.shapes()[k] for k in ("nodes", "places")], strict=True)}
    assert x[2] > x[3] > x[4] or x[2] < x[3] < x[4], "2 now stands where 4 was"
    missing = controller.export()["missing"]
    assert missing == [{"kind": "diagnose", "change": state["undo"]}]
    controller.step(back=True)
    assert controller.export()["missing"] == []
    with pytest.raises(InputError, match="no place"):
        controller.accept(1)
    with pytest.raises(InputError, match="no row 3"):
        controller.accept(2)


def test_labels_stay_an_effect_where_a_point_is_hit_and_measured(swapped: Path) -> None:
    controller = opened(swapped)
    modal: ModalData = controller._workbench.modal(controller.study)
    entries = [{"name": "swapped_points", "points": [4, 5]}]
    assert exchanged_points(entries, modal, {5}) == (entries, {})
    kept, places = exchanged_points(entries, modal, set())
    assert kept == []
    assert places["5"] == modal.geometry.at([4])[0].tolist()


def test_the_places_after_an_exchange_are_those_of_the_file(swapped: Path) -> None:
    controller = opened(swapped)
    controller.act("accept", {"effects": [], "places": {"2": [0.1, 0.0, 0.0]}})
    text = study_text(controller._opened, controller._history.now.content, "x", swapped.parent)
    assert tomllib.loads(text)["test"]["places"] == {"2": [0.1, 0.0, 0.0]}
