"""Commands that are killed with -9 leave nothing torn, and go on; ``benchmarks/kills.py`` does it by the hundred."""

from __future__ import annotations

import importlib.util
import random
import shutil
import sys
from pathlib import Path
from types import ModuleType

import pytest

PROGRAM = Path(__file__).resolve().parents[3] / "benchmarks" / "kills.py"

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc to see processes")


@pytest.fixture(scope="module")
def kills() -> ModuleType:
    spec = importlib.util.spec_from_file_location("kills", PROGRAM)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["kills"] = module  # where a dataclass looks for its types
    spec.loader.exec_module(module)
    return module


def modes_alone(folder: Path) -> None:
    for number in range(8):
        place = folder / "fleet" / f"part{number}"
        place.mkdir(parents=True)
        (place / "modes.csv").write_text(f"frequency,sigma\n{10 + number},0.01\n65.1,0.02\n")
        (place / "study.toml").write_text('[test]\nmodes = "modes.csv"\n')


@pytest.mark.long
def test_a_batch_that_is_killed_loses_nothing(kills: ModuleType, tmp_path: Path) -> None:
    words = ("batch", "fleet", "-o", "t.csv", "--json-dir", "parts", "--resume")
    before = {"t.csv": b"study,title\nbefore,before\n"}
    job = kills.Job("batch", words, modes_alone, before, store="t.csv.jsonl")
    whole = kills.whole_run(job, tmp_path)
    assert set(whole.files) >= {"t.csv", "t_modes.csv", "t.csv.jsonl", "parts/part7/study.json"}
    _, faults = kills.kill_once(job, "stored", whole, random.Random(1))
    assert faults == []


@pytest.mark.slow
def test_commands_that_are_killed_leave_whole_files(kills: ModuleType, tmp_path: Path) -> None:
    rng = random.Random(1)
    for job in kills.JOBS:
        if job.name != "blind":
            whole = kills.whole_run(job, tmp_path)
            shutil.rmtree(tmp_path)
            tmp_path.mkdir()
            for when in ("random", "writing"):
                _, faults = kills.kill_once(job, when, whole, rng)
                assert faults == [], (job.name, when)


def test_what_is_torn_lost_or_strange_is_found(kills: ModuleType) -> None:
    job = kills.Job("one", (), modes_alone, dated=("r.html",))
    whole = kills.Whole({"a": b"12", "r.html": b"1</html>\n"}, 1.0, 0.0)
    assert kills.faults_of(job, {"a": b"12", "r.html": b"2</html>\n"}, whole, {}) == []
    assert kills.faults_of(job, {"a": b"old"}, whole, {"a": b"old"}) == []
    torn = kills.faults_of(job, {"a": b"1", "r.html": b"2"}, whole, {"a": b"old"})
    assert torn == ["a: torn, 1 bytes of 2", "r.html: torn, 1 bytes of 9"]
    assert kills.faults_of(job, {"b": b"1"}, whole, {"a": b"old"}) == ["a: lost", "b: should not be there"]
