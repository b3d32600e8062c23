"""What is done is kept, can be taken back, and comes to the numbers of the command line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from opening import FAINT, opened

from acquisition.errors import InputError, ModalkitError
from modalkit.app.actions import ACTIONS
from modalkit.app.history import History, State
from modalkit.app.opened import relocated
from modalkit.app.store import Store
from modalkit.app.toml import toml_text
from modalkit.output.whole import plain
from modalkit.study.read import read_study
from modalkit.workflow.case import process

TEXTS = st.text(st.characters(codec="utf-8"), max_size=20)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**60), 2**60)
VALUES = st.recursive(TEXTS | NUMBERS | st.booleans(), lambda one: st.lists(one, max_size=3), max_leaves=6)
TABLES = st.recursive(
    st.dictionaries(TEXTS, VALUES, max_size=4),
    lambda one: st.dictionaries(TEXTS, VALUES | one | st.lists(one, min_size=1, max_size=2), max_size=4),
    max_leaves=6,
)


@pytest.mark.long
@given(TABLES)
def test_tables_are_read_back_as_they_were_written(tables):
    assert tomllib.loads(toml_text(tables)) == tables


def test_undo_and_redo_go_through_every_state():
    history = History((State.of({"n": 0}, "open"),))
    for n in range(1, 4):
        history = history.then({"n": n}, f"set {n}")
    assert [history.now.content["n"], history.undo_label, history.redo_label] == [3, "set 3", None]
    back = history.undone().undone()
    assert [back.now.content["n"], back.undo_label, back.redo_label] == [1, "set 1", "set 2"]
    assert back.redone().redone() == history
    other = back.then({"n": 9}, "set 9")
    assert [state.content["n"] for state in other.states] == [0, 1, 9]
    assert back.then({"n": 1}, "nothing") is back
    first = back.undone().undone()
    assert first.now.content["n"] == 0
    assert first.undo_label is None


def test_a_change_leaves_the_tables_it_was_given():
    content = {"test": {"files": ["a.uff"], "add": [12.0]}}
    before = json.dumps(content)
    changed, label = ACTIONS["drop"](content, {"hertz": 12.05})
    assert json.dumps(content) == before
    assert changed == {"test": {"files": ["a.uff"]}}, "a drop takes back a pick"
    assert label == "drop 12.05 Hz"


@pytest.mark.parametrize(
    ("proposed", "used", "key"),
    [(True, False, "leave"), (False, True, "use"), (True, True, None), (False, False, None)],
)
def test_only_a_decision_against_the_proposal_is_stated(proposed, used, key):
    content = {"test": {"files": ["a.uff"], "leave": [["1+Z", 2]], "use": [["1+Z", 3]]}}
    arguments = {"point": "1+z", "hit": 2, "used": used, "proposed": proposed}
    test = ACTIONS["hit"](content, arguments)[0]["test"]
    stated = [k for k in ("use", "leave") if ["1+z", 2] in test.get(k, [])]
    assert stated == ([] if key is None else [key])
    assert test["use"][0] == ["1+Z", 3]


@pytest.mark.parametrize("arguments", [{}, {"hertz": "x"}, {"hertz": None}, {"hertz": []}])
def test_a_change_that_lacks_something_is_an_error_on_purpose(arguments):
    with pytest.raises(InputError):
        ACTIONS["pick"]({"test": {}}, arguments)


@pytest.mark.long
def test_the_study_shows_what_the_command_line_gives(beam):
    controller = opened(beam)
    controller.act("hit", {"point": "1+Z", "hit": 2, "used": False, "proposed": True})
    controller.act("order", {"order": 40})
    controller.act("references", {"names": ["1+Z", "2+Z", "5+Z"]})
    controller.act("band", {"low": 10, "high": 480})
    folder = Path(controller.export()["folder"])
    _, model = process(read_study(folder / "study.toml"))
    shown = plain(controller.modes())["table"]
    assert [row["frequency_hz"] for row in shown] == model.modal.frequency.tolist()
    assert [row["damping_sigma"] for row in shown] == model.modal.damping_sigma.tolist()
    assert len(model.references) == 3
    assert max(model.chart.orders) <= 40


def test_picks_and_drops_are_those_of_one_identification(faint):
    controller = opened(faint)
    before = plain(controller.modes())["table"]
    controller.provisional(FAINT, 0)
    controller.act("pick", {"hertz": FAINT})
    controller.act("drop", {"hertz": before[0]["frequency_hz"]})
    found = plain(controller.modes())["table"]
    from modalkit import read

    model = read(faint).identify(add=[FAINT], drop=[before[0]["frequency_hz"]])
    assert [row["frequency_hz"] for row in found] == model.modal.frequency.tolist()
    assert [row["frequency_sigma_hz"] for row in found] == model.modal.frequency_sigma.tolist()
    assert {row["origin"] for row in found} == {"named", "chain"}
    controller.step(back=True)
    controller.step(back=True)
    assert plain(controller.modes())["table"] == before


REFUSED = [
    ("pick", {"hertz": 3000.0}),
    ("drop", {"hertz": 300.0}),
    ("band", {"low": 400, "high": 20}),
    ("hit", {"point": "9+Z", "hit": 1, "used": False, "proposed": True}),
    ("references", {"names": ["9+Z"]}),
    ("set", {"path": ["model", "length"], "value": "376 kg"}),
    ("set", {"path": ["model", "lenght"], "value": 1.0}),
    ("accept", {"effects": [{"name": "nonsense"}]}),
    ("pair", {"hertz": 300.0, "model": 1}),
    ("pair", {"hertz": 24.47, "model": 99}),
    ("text", {"text": "title = "}),
    ("no_such_change", {}),
]


@pytest.mark.parametrize(("name", "arguments"), REFUSED)
def test_a_change_that_cannot_be_is_refused_and_nothing_is_changed(beam, name, arguments):
    controller = opened(beam)
    state = controller.state()
    with pytest.raises(ModalkitError):
        controller.act(name, arguments)
    assert controller.state() == state
    assert opened(beam).state() == state


def test_a_closed_app_is_gone_on_with_where_it_was(beam):
    first = opened(beam)
    first.act("order", {"order": 50})
    first.act("drop", {"hertz": 24.47})
    first.step(back=True)
    again = opened(beam)
    assert again.state() == first.state()
    assert again.step(back=False)["undo"] == "drop 24.47 Hz"


def test_a_study_that_was_changed_meanwhile_is_opened_as_it_is(beam):
    opened(beam).act("order", {"order": 50})
    beam.write_text(beam.read_text(encoding="utf-8") + "\n# a word\n", encoding="utf-8")
    assert opened(beam).state()["undo"] is None


def test_an_autosave_that_is_torn_is_passed_over(beam):
    opened(beam).act("order", {"order": 50})
    saved = Store.beside(beam).folder / "session.json"
    text = saved.read_text(encoding="utf-8")
    for cut in (0, 1, len(text) // 2, len(text) - 1):
        saved.write_text(text[:cut], encoding="utf-8")
        assert opened(beam).state()["undo"] is None


KILLED = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from opening import opened
controller = opened(Path(sys.argv[1]))
print("ready", flush=True)
for order in range(20, 400):
    controller._keep(controller._history.then({**controller._history.now.content, "note": str(order)}, str(order)))
    print(order, flush=True)
"""


@pytest.mark.long
def test_killed_at_any_time_the_state_is_the_last_or_the_one_before(beam):
    words = [sys.executable, "-c", KILLED, str(beam), str(Path(__file__).parent)]
    process_ = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process_.stdout is not None
    last = ""
    for line in process_.stdout:
        last = line.strip()
        if last == "150":
            process_.kill()
            break
    last = (process_.stdout.read().split() or [last])[-1]
    process_.stdout.close()
    process_.wait()
    label = int(str(opened(beam).state()["undo"]))
    assert label in {int(last), int(last) + 1}


def test_a_folder_that_cannot_be_written_is_left_alone(beam, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(os, "access", lambda path, mode: "home" in str(path))
    controller = opened(beam)
    controller.act("order", {"order": 50})
    assert list((tmp_path / "home" / "modalkit").rglob("session.json"))
    assert str(controller.export()["folder"]).startswith(str(tmp_path / "home"))


@pytest.mark.long
def test_pairs_that_are_stated_stand(beam):
    controller = opened(beam)
    found = plain(controller.model())["correlation"]["pairs"]
    assert [(p["test_mode"], p["model_mode"]) for p in found] == [(1, 1), (2, 2), (3, 3)]
    controller.act("pair", {"hertz": found[1]["test_hz"], "model": 4})
    stated = plain(controller.model())["correlation"]["pairs"]
    assert (2, 4) in [(p["test_mode"], p["model_mode"]) for p in stated]
    controller.act("pair", {"hertz": found[1]["test_hz"], "model": 0})
    without = plain(controller.model())["correlation"]
    assert [p["test_mode"] for p in without["pairs"]] == [1, 3]
    assert [u["mode"] for u in without["unpaired_test"]] == [2]
    controller.act("pair", {"hertz": found[1]["test_hz"], "model": None})
    assert plain(controller.model())["correlation"]["pairs"] == found


def test_files_are_named_from_another_folder(tmp_path):
    content = {"test": {"files": ["a.uff", "../b.uff"], "band": [1.0, 2.0]}, "model": {"nodes": "n.csv"}}
    content["hypothesis"] = [{"name": "loose", "deck": "b.inp"}]
    moved = relocated(content, tmp_path / "study", tmp_path / "study" / "x" / "y")
    assert moved["test"]["files"] == ["../../a.uff", "../../../b.uff"]
    assert moved["model"]["nodes"] == "../../n.csv"
    assert moved["hypothesis"] == [{"name": "loose", "deck": "../../b.inp"}]
    assert content["test"]["files"] == ["a.uff", "../b.uff"]


def test_modes_alone_are_shown_and_nothing_else(samples):
    controller = opened(samples / "beam_dry" / "published.toml")
    assert controller.hits()["hits"] == []
    assert controller.modes()["identified"] is False
    assert controller.shapes()["modes"] == []
    assert len(plain(controller.model())["correlation"]["pairs"]) >= 3
    with pytest.raises(InputError):
        controller.frf(0)


def test_without_the_extra_the_command_says_what_to_install(beam, monkeypatch):
    from modalkit.app.serve import serve

    monkeypatch.setitem(sys.modules, "uvicorn", None)
    with pytest.raises(InputError, match="extra"):
        serve(beam, browser=False)


def test_a_port_that_is_taken_is_an_error_on_purpose(beam):
    import socket

    from modalkit.app.serve import serve

    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with pytest.raises(InputError, match="give another"):
            serve(beam, port=other.getsockname()[1], browser=False)


@pytest.mark.long
def test_hits_are_judged_once_and_decisions_come_to_the_numbers_of_the_command_line(beam, monkeypatch):
    from modalkit.workflow import judged_hits

    controller = opened(beam)
    controller.hits()
    monkeypatch.setattr(judged_hits, "judge_hits", None)  # not called again
    controller.act("hit", {"point": "1+Z", "hit": 2, "used": False, "proposed": True})
    controller.act("estimator", {"name": "H2"})
    shown = plain(controller.modes())["table"]
    folder = Path(controller.export()["folder"])
    monkeypatch.undo()
    _, model = process(read_study(folder / "study.toml"))
    assert [row["frequency_hz"] for row in shown] == model.modal.frequency.tolist()
    assert [row["damping_sigma"] for row in shown] == model.modal.damping_sigma.tolist()


def test_an_answer_stays_where_only_the_update_changes(beam):
    """A diagnosis does not read [update]; an update does, and both read the model."""
    controller = opened(beam)
    kinds = ("diagnose", "plan", "update")
    before = {kind: controller._folder(kind) for kind in kinds}
    controller.act("set", {"path": ["update", "parameters"], "value": ["density"]})
    after = {kind: controller._folder(kind) for kind in kinds}
    assert [before[kind] == after[kind] for kind in kinds] == [True, True, False]
    controller.act("set", {"path": ["model", "width"], "value": "31 mm"})
    assert not set(after.values()) & {controller._folder(kind) for kind in kinds}
