"""The page of the model: what can be moved there, and that it shows what the study would."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from glider import PARTS, SOFT, make_glider
from opening import opened

from acquisition.errors import InputError
from modalkit.app.acceptance import acceptable, accepted_entries
from modalkit.app.model_page import Moved
from modalkit.output.whole import plain
from modalkit.views.shapes import Changed, shapes_page
from updating.models.state import State

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"


@pytest.mark.long
def test_a_slider_shows_what_the_study_shows_with_the_same_number(beam):
    """Frequencies of a bending beam follow the root of E; an effect moved is the effect put into the model."""
    controller = opened(beam)
    nominal = controller.moved(Moved(), 0)
    stiffer = controller.moved(Moved((), {"E": 1.1}), 0)
    ratio = np.asarray(stiffer["model_hz"]) / np.asarray(nominal["model_hz"])
    assert ratio == pytest.approx(np.sqrt(1.1), rel=1e-6)
    entry = {"name": "sensor_mass", "mass": 0.0086}
    moved = plain(controller.moved(Moved((entry,)), 0))
    controller.act("accept", {"effects": [entry]})
    put = plain(controller.moved(Moved(), 0))
    assert moved["pairs"] == put["pairs"]
    assert moved["frf"]["model"] == pytest.approx(put["frf"]["model"], rel=1e-9)


@pytest.mark.long
def test_the_slider_of_a_region_finds_what_the_specimen_has_lost(tmp_path):
    """Where the outer left wing is as soft as in the full matrices that made the test, the gap closes on all modes."""
    controller = opened(make_glider(tmp_path / "glider"))
    page = controller.model()
    assert {one["region"] for one in page["factors"]} == {"", *PARTS}
    assert "thickness" not in {one["name"] for one in page["factors"]}  # imported matrices know none
    stated = controller.moved(Moved(), 0)["pairs"]
    moved = controller.moved(Moved((), {"wing_left_outer.E": SOFT}), 0)["pairs"]
    assert max(abs(one["error_percent"]) for one in stated) > 5.0
    assert len(moved) == 17 > len(stated)
    assert max(abs(one["error_percent"]) for one in moved) < 0.02
    with pytest.raises(InputError, match=r"no factor fin\.thickness"):
        controller.moved(Moved((), {"fin.thickness": 0.9}), 0)


def test_a_changed_model_stands_beside_the_test_on_the_same_surface(beam):
    """With a modulus a tenth larger every frequency is the root of 1.1 higher, and no shape is another."""
    controller = opened(beam)
    study = controller.study
    modal, beside = controller._workbench.modal(study), controller._beside(study)
    stiff = beside.predictor.for_test(beside.predictor.measured, (lambda _: State(factors={"E": 1.1}),))
    page = plain(shapes_page(modal, beside, [Changed("stiffer", stiff)]))
    first, (other,) = page["model"], page["changed"]
    assert other["name"] == "stiffer"
    assert other["surface"] is None and first["surface"] is not None
    for one, two in zip(first["modes"], other["modes"], strict=True):
        assert two["frequency_hz"] == pytest.approx(np.sqrt(1.1) * one["frequency_hz"], rel=1e-6)
        assert two["mac"] == pytest.approx(one["mac"], rel=1e-9)
        assert np.array(two["surface"]) == pytest.approx(np.array(one["surface"]), abs=1e-9)


def test_a_longer_model_is_drawn_longer_and_moves_the_points_where_they_are(beam):
    """Points keep their distance from the free end, and MAC at them is that of the modal constants."""
    controller = opened(beam)
    study = controller.study
    modal, beside = controller._workbench.modal(study), controller._beside(study)
    long = beside.predictor.for_test(beside.predictor.measured, (lambda _: State(factors={"length": 1.1}),))
    page = plain(shapes_page(modal, beside, [Changed("longer", long)]))
    (other,) = page["changed"]
    ends = np.array(other["surface"]["places"])[:, 0]
    assert (ends.min(), ends.max()) == pytest.approx((-0.0376, 0.376))
    for test, model in zip(page["modes"], other["modes"], strict=True):
        u, v = np.array(test["re"]).ravel(), np.array(model["at_points"]).ravel()
        assert (u @ v) ** 2 / ((u @ u) * (v @ v)) == pytest.approx(model["mac"], abs=2e-3)
        points, at = np.array(page["places"])[:, 0], np.array(model["at_points"])[:, 2]
        assert np.interp(points, ends, np.array(model["surface"])) == pytest.approx(
            at, abs=2e-3 * abs(at).max()
        )


@pytest.mark.long
def test_only_what_a_kind_of_model_has_can_be_edited_and_in_handy_units(beam, frame):
    page = plain(opened(beam).model())
    fields = {field["label"]: field for field in page["fields"]}
    assert (fields["Modulus E"]["unit"], fields["Modulus E"]["times"]) == ("GPa", 1e9)
    assert fields["Theory"]["choices"] == ["euler-bernoulli", "rayleigh", "timoshenko"]
    controller = opened(beam)
    controller.act("set", {"path": ["model", "material", "E"], "value": "70 GPa"})
    assert controller.study.spec().material.E == 70e9
    own = {field["label"] for field in plain(opened(frame).model())["fields"]}
    assert "Modulus E" not in own and "Theory" not in own and "Tolerance of E" in own


def moves(sliders: list[dict[str, Any]], end: str) -> Iterator[dict[str, Any]]:
    """Yield every effect at every place that it has sliders for, at an end of each."""
    for effect in sliders:
        ranges = {p["name"]: p for p in effect["parameters"]}
        for form in effect["forms"]:
            values = {n: v if end == "start" else ranges[n][end] for n, v in form["start"].items()}
            yield {
                "name": effect["name"],
                **form["names"],
                **{n: v for n, v in values.items() if v is not None},
            }


@pytest.mark.long
@pytest.mark.parametrize("end", ["start", "low", "high"])
def test_every_effect_that_has_sliders_can_be_moved_to_their_ends(beam, end):
    controller = opened(beam)
    entries = list(moves(plain(controller.model())["sliders"], end))
    assert len(entries) > 10
    for entry in entries:
        assert controller.moved(Moved((entry,)), 0)["model_hz"] is not None


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the study of a frame by matrices, with regions, supports and hypotheses."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(EXAMPLES))
        return Path(importlib.import_module("frame").make(tmp_path_factory.mktemp("frame")))


@pytest.mark.long
def test_what_has_a_name_in_the_model_is_moved_there_and_put_into_it(frame):
    """Regions, supports and node sets: every place answers, and the same entry makes the same model."""
    controller = opened(frame)
    page = plain(controller.model())
    entries = list(moves(page["sliders"], "start"))
    named = {key for entry in entries for key in ("region", "support") if key in entry}
    assert named == {"region", "support"}
    regions = [entry["region"] for entry in entries if entry["name"] == "local_mass"]
    assert sorted(regions) == sorted(
        {region["name"] for region in controller.study.model_dump()["model"]["region"]}
    )
    shown = [plain(controller.moved(Moved((entry,)), 0))["model_hz"] for entry in entries]
    soft = {"name": "local_stiffness", "region": "beam_1", "loss": 0.5}
    moved = plain(controller.moved(Moved((soft,)), 0))["model_hz"]
    assert moved[0] < page["model_hz"][0]
    controller.act("accept", {"effects": [soft]})
    assert plain(controller.model())["model_hz"] == pytest.approx(moved, rel=1e-9)
    assert len({tuple(one) for one in shown}) > len(regions)


def row(*effects: str, **values: Any) -> dict[str, Any]:
    """Return a row of a ranking as the document of a diagnosis has it."""
    return {"effects": effects, "parameters": {name: {"value": value} for name, value in values.items()}}


@pytest.mark.long
def test_a_row_of_the_diagnosis_is_put_where_its_names_say(frame):
    controller = opened(frame)
    predictor = controller._workbench.predictor(controller.study)
    values = {
        "local_stiffness.region": "beam_2",
        "local_stiffness.loss": 0.3,
        "local_stiffness.compliance": 0.43,
    }
    entries = accepted_entries(row("local_stiffness", **values), predictor)
    assert entries == [{"name": "local_stiffness", "region": "beam_2", "loss": 0.3}]
    later = accepted_entries(row("local_stiffness", **values), predictor, since_baseline=True)
    assert later == [entries[0] | {"before": False}]
    controller.act("accept", {"effects": entries})
    assert controller.study.model.effect[-1] == entries[0]


@pytest.mark.long
def test_a_hypothesis_is_not_put_into_the_model(frame):
    controller = opened(frame)
    predictor = controller._workbench.predictor(controller.study)
    found = row("local_mass", "joint 3 is loose", **{"joint 3 is loose.amount": 1.0})
    with pytest.raises(
        InputError, match=r"'joint 3 is loose' is a hypothesis .* cannot be put into the model"
    ):
        accepted_entries(found, predictor)
    assert [acceptable(names) for names in (found["effects"], (), ("local_mass",))] == [False, False, True]
