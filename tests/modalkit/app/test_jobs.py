"""Long work: one at a time, stopped within a second, its error in a line, its result that of the command line."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import pytest
from opening import opened

from acquisition.errors import InputError
from modalkit.app.bench import Bench
from modalkit.app.store import Store
from modalkit.output.update import to_json
from modalkit.output.whole import plain
from modalkit.study.read import read_study
from modalkit.workflow.update import update_studies

PATIENCE = 120.0
"""Seconds that a process may take on a machine shared with others."""


def ended(bench: Bench, kind: str) -> dict[str, Any]:
    """Return how work stands once it has ended."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        found = bench.work(kind)
        if found["job"] is None or found["job"]["state"] != "running":
            return found
        time.sleep(0.1)
    raise AssertionError("the work does not end")


def test_a_stop_takes_less_than_a_second_and_leaves_nothing(beam):
    bench = opened(beam)
    bench.start("diagnose")
    with pytest.raises(InputError, match="diagnose is running"):
        bench.start("update")
    until = time.monotonic() + PATIENCE
    while not bench.work("diagnose")["job"]["stages"] and time.monotonic() < until:
        time.sleep(0.05)
    begun = time.monotonic()
    assert bench.stop()["job"]["state"] == "stopped"
    assert time.monotonic() - begun < 1.0
    assert ended(bench, "diagnose")["result"] is None
    assert not list((Store.beside(beam).folder / "results").iterdir())
    bench.stop()  # once more is no harm


def test_the_result_is_what_the_command_line_writes(beam):
    bench = opened(beam)
    bench.act("set", {"path": ["update", "parameters"], "value": ["E", "length"]})
    bench.start("update")
    found = ended(bench, "update")
    assert found["job"]["state"] == "done"
    assert [stage["name"] for stage in found["job"]["stages"]] == ["reading and identifying", "updating"]
    folder = Path(bench.export()["folder"])
    own = plain(to_json(update_studies([read_study(folder / "study.toml")])))
    assert json.loads((folder / "update.json").read_text(encoding="utf-8")) == own
    assert {p["name"] for p in own["parameters"]} == {"E", "length"}
    assert opened(beam).work("update")["result"] == found["result"], "a new server finds it again"


def test_what_lies_in_the_current_folder_is_not_run(beam, tmp_path, monkeypatch):
    """Neither a package of our name beside the study, nor a module that work imports."""
    there = tmp_path / "there"
    for name in ("modalkit/__init__.py", "modalkit/app/__init__.py", "modalkit/app/work.py", "scipy.py"):
        (there / name).parent.mkdir(parents=True, exist_ok=True)
        (there / name).write_text(f'raise SystemExit("this is {name} of the folder")\n', encoding="utf-8")
    monkeypatch.chdir(there)
    bench = opened(beam)
    bench.start("plan")
    found = ended(bench, "plan")
    assert found["job"]["error"] == ""
    assert found["job"]["state"] == "done"


def test_a_result_belongs_to_its_state(beam):
    bench = opened(beam)
    bench.start("update")
    found = ended(bench, "update")["result"]
    assert found is not None
    bench.act("order", {"order": 40})
    assert bench.work("update")["result"] is None
    bench.step(back=True)
    assert bench.work("update")["result"] == found


def test_work_that_cannot_be_done_says_why(beam):
    bench = opened(beam)
    bench.act("set", {"path": ["update", "parameters"], "value": ["nonsense"]})
    bench.start("update")
    found = ended(bench, "update")
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
    _watch(job)
    assert job.state == "failed"
    assert job.error == "ValueError: this went wrong"
    assert [name for name, _ in job.stages] == ["on and on"]
