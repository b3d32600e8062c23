"""A model made from the form, and what warnings ask for."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from opening import opened

from acquisition import read_uff, write_uff
from acquisition.errors import ModalkitError
from modalkit.app.actions import ACTIONS
from modalkit.app.asked import asks
from modalkit.app.form import FORM, TYPES
from modalkit.output.whole import plain
from modalkit.study.read import Study

BEAM = {
    "model.length": "376",
    "model.width": "30.5 mm",
    "model.thickness": "4.7625",
    "model.material.E": "210",
    "model.material.density": "7850",
    "model.material.poisson": "",
    "model.clamped": ["x0"],
    "model.theory": "euler-bernoulli",
    "test.exponential_window": "8",
    "test.sensor_masses": "",
    "tolerances.E": "2 percent",
}


@pytest.fixture
def alone(beam: Path, tmp_path: Path) -> Path:
    """Return a file of hits without a study beside it."""
    return Path(shutil.copy(beam.parent / "beam_dry.uff", tmp_path / "hits.uff"))


def test_a_model_of_the_form_is_that_of_the_study(alone: Path, beam: Path) -> None:
    controller = opened(alone)
    assert plain(controller.model())["form"]["types"].keys() == TYPES.keys()
    controller.act("model", {"type": "beam", "values": BEAM})
    made, study = controller.study, opened(beam).study
    assert made.model is not None
    assert study.model is not None
    assert made.spec().length == study.spec().length
    assert made.model.material == study.model.material
    assert made.test.exponential_window == 8.0
    assert made.tolerances.E == 0.02
    page = controller.model()
    assert page["form"] is None
    assert len(page["correlation"]["pairs"]) >= 3
    controller.step(back=True)
    assert controller.study.model is None


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"model.length": ""}, "Length along x"),
        ({"model.length": "376 kg"}, "model.length"),
        ({"model.deck": "part.inp"}, "no model.deck"),
        ({"test.sensor_masses": "5+Z 8 g"}, "5\\+Z: 8.6 g"),
        ({"test.places": "1 0, 0"}, "1: 50 mm, 0, 0"),
        ({"tolerances.length": "0.5 mm"}, "tolerances.length.*a ratio is asked for"),
    ],
)
def test_a_form_that_cannot_be_read_names_its_field(alone: Path, changed, message: str) -> None:
    controller = opened(alone)
    before = controller.state()
    with pytest.raises(ModalkitError, match=message):
        controller.act("model", {"type": "beam", "values": BEAM | changed})
    assert controller.state() == before


def test_lists_of_the_form_become_tables() -> None:
    values = BEAM | {
        "test.sensor_masses": "5+Z: 8.6 g, 7+Z: 0.01",
        "test.places": "1: 0, 0.1, 0\n2: 5 mm, 0, 0\n3: 50 mm",
    }
    content, _ = ACTIONS["model"]({"test": {"files": ["a.uff"]}}, {"type": "beam", "values": values})
    assert content["test"]["sensor_masses"] == {"5+Z": "8.6 g", "7+Z": 0.01}
    assert content["test"]["places"] == {
        "1": [0.0, 0.1, 0.0],
        "2": ["5 mm", 0.0, 0.0],
        "3": ["50 mm", 0.0, 0.0],
    }


def test_every_field_of_the_form_is_a_key_of_the_study() -> None:
    for field in FORM:
        table, *rest = field.path.split(".")
        place = Study.model_fields[table].annotation
        for key in rest:
            options = [place, *getattr(place, "__args__", ())]
            place = next(o.model_fields[key].annotation for o in options if hasattr(o, "model_fields"))


def test_a_warning_has_the_key_that_it_asks_for() -> None:
    decay = "a.uff: the force decays at 8.03 1/s (its noise): an exponential window seems to have been applied; state "
    found = asks([decay + "it with --decay or exponential_window", "3 modes have no partner"])
    assert len(found) == 1
    (asked,) = found.values()
    assert [(key["path"], key["proposed"]) for key in asked["keys"]] == [("test.exponential_window", "8.03")]
    (asked,) = asks(['fitted as averages: state frf_window = "none" if there was no window']).values()
    assert asked["keys"][0]["proposed"] == "none"
    (asked,) = asks(["its force is clipped; see its record, and leave it out with --leave 3-Z:2"]).values()
    assert asked["hit"] == ("3-Z", 2)


def test_the_value_that_a_warning_proposes_answers_it(alone: Path) -> None:
    """The hits of the beam were windowed; a file that does not say so makes the damping too high."""
    (test,) = read_uff(alone).tests
    write_uff(alone, tests=[replace(test, decay=0.0)])
    controller = opened(alone)
    page = controller.hits()
    text, asked = next((text, asked) for text, asked in page["asks"].items() if asked["keys"])
    assert text in page["warnings"]
    key = asked["keys"][0]
    assert float(key["proposed"]) == pytest.approx(8.0, rel=0.02)
    controller.act("set", {"path": key["path"].split("."), "value": key["proposed"]})
    assert text not in controller.hits()["warnings"]
    assert controller.study.test.exponential_window == float(key["proposed"])
