"""Long work: one at a time, stopped within a second, its error in a line, its result that of the command line."""

from __future__ import annotations

import json
import os
import shutil
import time
from pathlib import Path
from typing import Any

import pytest
from opening import opened

from acquisition.errors import InputError
from modalkit.app.controller import Controller
from modalkit.app.digests import digest_of
from modalkit.app.opened import open_path
from modalkit.app.store import Store
from modalkit.app.work import KINDS, REPORT, Progress, run
from modalkit.output.update import to_json
from modalkit.output.whole import plain
from modalkit.study.read import read_study
from modalkit.workflow.update import update_studies

PATIENCE = 120.0
"""Seconds that a process may take on a machine shared with others."""

FIRST, LOWER = "24.47", "24.23"
"""The first frequency of the published table, and another one [Hz]."""


def ended(controller: Controller, kind: str) -> dict[str, Any]:
    """Return how work stands once it has ended."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        found = controller.work(kind)
        if found["job"] is None or found["job"]["state"] != "running":
            return found
        time.sleep(0.1)
    raise AssertionError("the work does not end")


@pytest.mark.long
def test_a_stop_takes_less_than_a_second_and_leaves_nothing(beam):
    controller = opened(beam)
    controller.start("diagnose")
    with pytest.raises(InputError, match="diagnose is running"):
        controller.start("update")
    until = time.monotonic() + PATIENCE
    while not controller.work("diagnose")["job"]["stages"] and time.monotonic() < until:
        time.sleep(0.05)
    begun = time.monotonic()
    assert controller.stop()["job"]["state"] == "stopped"
    assert time.monotonic() - begun < 1.0
    assert ended(controller, "diagnose")["result"] is None
    assert not list((Store.beside(beam).folder / "results").iterdir())
    controller.stop()  # once more is no harm


@pytest.mark.long
def test_single_causes_are_seen_while_the_diagnosis_goes_on(beam):
    controller = opened(beam)
    controller.start("diagnose")
    until = time.monotonic() + PATIENCE
    while len((job := controller.work("diagnose")["job"])["found"]) < 3 and time.monotonic() < until:
        assert job["state"] == "running", job
        time.sleep(0.05)
    first, *others = job["found"]
    assert (first["name"], first["power"]) == ("", 0.0)
    assert len({one["name"] for one in others}) == len(others) > 1
    controller.stop()
    assert controller.work("diagnose")["result"] is None


@pytest.mark.long
def test_the_result_is_what_the_command_line_writes(beam):
    controller = opened(beam)
    controller.act("set", {"path": ["update", "parameters"], "value": ["E", "length"]})
    controller.start("update")
    found = ended(controller, "update")
    assert found["job"]["state"] == "done"
    stages = ["reading and identifying", "updating", "writing the report"]
    assert [stage["name"] for stage in found["job"]["stages"]] == stages
    folder = Path(controller.export()["folder"])
    own = plain(to_json(update_studies([read_study(folder / "study.toml")])))
    assert json.loads((folder / "update.json").read_text(encoding="utf-8")) == own
    assert {p["name"] for p in own["parameters"]} == {"E", "length"}
    assert "modalkit update study.toml" in (folder / "update.html").read_text(encoding="utf-8")
    assert opened(beam).work("update")["result"] == found["result"], "a new server finds it again"


@pytest.mark.long
def test_what_lies_in_the_current_folder_is_not_run(beam, tmp_path, monkeypatch):
    """Neither a package of our name beside the study, nor a module that work imports."""
    there = tmp_path / "there"
    for name in ("modalkit/__init__.py", "modalkit/app/__init__.py", "modalkit/app/work.py", "scipy.py"):
        (there / name).parent.mkdir(parents=True, exist_ok=True)
        (there / name).write_text(f'raise SystemExit("this is {name} of the folder")\n', encoding="utf-8")
    monkeypatch.chdir(there)
    controller = opened(beam)
    controller.start("plan")
    found = ended(controller, "plan")
    assert found["job"]["error"] == ""
    assert found["job"]["state"] == "done"


@pytest.mark.long
def test_a_result_belongs_to_its_state(beam):
    controller = opened(beam)
    controller.start("update")
    found = ended(controller, "update")["result"]
    assert found is not None
    controller.act("order", {"order": 40})
    assert controller.work("update")["result"] is None
    controller.step(back=True)
    assert controller.work("update")["result"] == found


def lowered(modes: Path) -> None:
    """Put a lower first frequency into the table of modes, under the same name, of the same size and time."""
    before = modes.stat()
    text = modes.read_text(encoding="utf-8")
    assert text.count(FIRST) == 1
    modes.write_text(text.replace(FIRST, LOWER), encoding="utf-8")
    os.utime(modes, ns=(before.st_atime_ns, before.st_mtime_ns))


@pytest.mark.long
def test_a_result_belongs_to_its_files(samples):
    """Other data under the same name: shown at once, without the result of those before; theirs with them."""
    study = samples / "beam_dry" / "published.toml"
    modes, controller = samples / "beam_dry" / "modes.csv", opened(study)
    original, table = modes.read_bytes(), plain(controller.modes())["table"]
    pairs = plain(controller.model())["correlation"]["pairs"]
    controller.start("update")
    found = ended(controller, "update")["result"]
    assert found is not None
    lowered(modes)
    again = opened(study)
    for one in (controller, again):
        assert one.work("update") == {"job": None, "result": None, "asks": {}}
        assert one.state()["results"] == []
        shown = plain(one.modes())["table"]
        assert [row["frequency_hz"] for row in (table[0], shown[0])] == [float(FIRST), float(LOWER)]
        assert plain(one.model())["correlation"]["pairs"] != pairs
    modes.write_bytes(original)
    assert controller.work("update")["result"] == again.work("update")["result"] == found


@pytest.mark.long
def test_hits_that_are_replaced_while_the_app_runs_are_read_anew(samples, tmp_path):
    """Those of a beam with a joint in place of those of the dry one."""
    hits = tmp_path / "hits.uff"
    shutil.copy(samples / "beam_dry" / "beam_dry.uff", hits)
    controller = opened(hits)
    before = plain(controller.modes())["table"]
    shutil.copy(samples / "beam_joint" / "beam_joint.uff", hits)
    assert plain(controller.modes())["table"] == plain(opened(hits).modes())["table"] != before


def test_a_digest_follows_what_decks_include_and_what_stands_beside_a_matrix(tmp_path):
    """Each file in turn is changed, and changed back; a deck that includes itself comes to an end."""
    texts = {
        "a.inp": "** a part\n*INCLUDE, INPUT=sub/b.inp\n*include,input = c.txt\n",
        "sub/b.inp": "*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=../sub/b.inp\n",
        "c.txt": "*MATERIAL, NAME=STEEL\n",
        "k.sti": "1 1 1.0\n",
        "k.dof": "1.3\n",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    named = [tmp_path / "a.inp", tmp_path / "k.sti", tmp_path / "not there"]
    first = digest_of(named)
    for name, text in texts.items():
        (tmp_path / name).write_text(text + "\n", encoding="utf-8")
        assert digest_of(named) != first, name
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert digest_of(named) == first
    (tmp_path / "not there").write_text("", encoding="utf-8")
    assert digest_of(named) != first


def test_a_file_that_is_changed_while_work_runs_makes_it_void(samples, tmp_path, capsys, monkeypatch):
    """What came of it is of neither the old file nor the new one."""
    study, folder = samples / "beam_dry" / "published.toml", tmp_path / "out"
    folder.mkdir()

    def change(path: Path, folder: Path, progress: Progress) -> dict[str, Any]:
        (folder / REPORT).write_text("half", encoding="utf-8")
        lowered(path.parent / "modes.csv")
        return {}

    monkeypatch.setitem(KINDS, "update", change)
    assert run("update", study, folder) == 2
    assert "changed meanwhile" in capsys.readouterr().out
    assert list(folder.iterdir()) == []


@pytest.mark.long
def test_work_that_cannot_be_done_says_why(beam):
    controller = opened(beam)
    controller.act("set", {"path": ["update", "parameters"], "value": ["nonsense"]})
    controller.start("update")
    found = ended(controller, "update")
    assert found["job"]["state"] == "failed"
    assert "nonsense" in found["job"]["error"]
    assert found["result"] is None


@pytest.mark.parametrize("kind", ["no_such_work", "../diagnose"])
def test_work_that_there_is_not(beam, kind):
    with pytest.raises(InputError):
        opened(beam).start(kind)
    assert opened(beam).report(kind) is None


NOISY = r"""
import json, sys
for _ in range(5000):
    sys.stderr.write("a warning that nobody reads\n")
print(json.dumps({"stage": "on and on"}), flush=True)
sys.exit("ValueError: this went wrong")
"""


def test_a_process_that_writes_much_is_read_and_its_last_words_are_kept(tmp_path):
    import subprocess
    import sys

    from modalkit.app.jobs import Job, _watch

    words = [sys.executable, "-c", NOISY]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    job = Job("update", "key", tmp_path, process, time.monotonic())
    _watch(job, tmp_path / "times.json")
    assert job.state == "failed"
    assert job.error == "ValueError: this went wrong"
    assert [name for name, _ in job.stages] == ["on and on"]


@pytest.mark.long
def test_a_process_that_waits_is_used_and_ended(beam):
    """The first of two updates is done by it; the second knows how long it will take."""
    controller = Controller(open_path(beam), Store.beside(beam), warm=True)
    assert controller.work("update")["result"] is None
    waiting = controller._jobs._waiting
    assert waiting is not None and waiting.poll() is None
    controller.start("update")
    assert controller._jobs.last.process is waiting
    assert controller._jobs.last.document()["remaining_s"] is None
    ended(controller, "update")
    controller.act("order", {"order": 40})
    controller.start("update")
    assert controller._jobs.last.document()["remaining_s"] > 0
    controller.stop()
    controller.work("update")
    last = controller._jobs._waiting
    controller.close()
    assert last.poll() is not None
