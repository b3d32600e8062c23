"""The diagnosing process: what it gets, what it answers, and what happens when it dies."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import blind_stub
import pytest
from blind_stub import NONE

from acquisition.errors import EstimationError
from modalkit.blind.diagnoser import Diagnoser
from updating import LIBRARY

pytestmark = pytest.mark.long

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
PROC = Path("/proc/self/task").is_dir()
MOST = tuple(sorted(set(LIBRARY) - {"E", "density", "thickness", "clamp_rotation", "lumped_mass"}))
"""Left out, so that a diagnosis takes a moment."""


@pytest.fixture(scope="module")
def warm() -> Iterator[Diagnoser]:
    with Diagnoser() as diagnoser:
        yield diagnoser


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of published modes, which is diagnosed in a moment."""
    folder = shutil.copytree(SAMPLES / "beam_dry", tmp_path_factory.mktemp("diagnoser") / "study")
    return folder / "published.toml"


@pytest.fixture(scope="module")
def answer(warm: Diagnoser, study: Path) -> dict[str, Any]:
    return warm(study, MOST)


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text("")
    return path


def assert_alike(one: Any, other: Any) -> None:
    """Hold two documents against each other; rounding differs from process to process on some processors."""
    assert type(one) is type(other)
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        one, other = list(one.values()), list(other.values())
    if isinstance(one, list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_alike(a, b)
    elif isinstance(one, float):
        assert one == pytest.approx(other, rel=1e-3, abs=1e-9, nan_ok=True)
    else:
        assert one == other


def test_warm_and_cold_give_the_same(warm: Diagnoser, study: Path, answer: dict[str, Any]) -> None:
    again = [answer, warm(study, MOST)]
    words = [sys.executable, "-m", "modalkit", "diagnose", study.name, "--json", "cold.json"]
    words += ["--without", ",".join(MOST)]
    subprocess.run(words, cwd=study.parent, check=True, capture_output=True)
    cold = json.loads((study.parent / "cold.json").read_text())
    assert_alike(again[0], cold)
    assert_alike(again[1], cold)
    assert cold["cause"]["ranking"]


def test_what_is_left_out_is_not_in_the_answer(warm: Diagnoser, study: Path, answer: dict[str, Any]) -> None:
    names = answer["cause"]["ranking"][0]["effects"]
    without = warm(study, (*MOST, names[0]))
    assert all(names[0] not in row["effects"] for row in without["cause"]["ranking"])


def test_a_failing_diagnosis_says_why_and_the_next_one_works(warm: Diagnoser, study: Path) -> None:
    wrong = study.with_name("wrong.toml")
    wrong.write_text("[test]\nfile = []\n")
    with pytest.raises(EstimationError, match=r"code 2: wrong\.toml: .*file"):
        warm(wrong)
    process = warm.process.pid
    with pytest.raises(EstimationError, match=r"code 2: --without nonsense"):
        warm(study, ("nonsense",))
    assert warm.process.pid == process


def test_a_diagnosis_that_takes_too_long_is_ended(
    warm: Diagnoser, study: Path, answer: dict[str, Any]
) -> None:
    warm.process.start()
    before, warm.process.timeout = warm.process.timeout, 0.1
    try:
        with pytest.raises(EstimationError, match=r"did not end within 0\.1 s"):
            warm(study)
    finally:
        warm.process.timeout = before
    assert warm(study, MOST) == answer


def children(pid: int) -> list[int]:
    return [int(n) for of in Path(f"/proc/{pid}/task").glob("*/children") for n in of.read_text().split()]


@pytest.mark.skipif(not PROC, reason="looks for the children of a process in /proc")
@pytest.mark.parametrize("victim", ["fork", "server"])
def test_a_diagnosis_killed_at_work_is_repeated(
    warm: Diagnoser, study: Path, answer: dict[str, Any], victim: str
) -> None:
    warm.process.start()
    first, killed = warm.process.pid, list[int]()
    assert first is not None

    def kill() -> None:
        while not (at_work := children(first)):
            time.sleep(0.01)
        killed.append(at_work[0] if victim == "fork" else first)
        os.kill(killed[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    assert warm(study, MOST) == answer
    killer.join()
    assert killed
    assert (warm.process.pid == first) == (victim == "fork")


@pytest.mark.skipif(not PROC, reason="looks for the processes in /proc")
def test_it_ends_when_the_one_who_asks_is_killed(study: Path) -> None:
    body = (
        "import sys\nfrom pathlib import Path\nfrom modalkit.blind.diagnoser import Diagnoser\n"
        "with Diagnoser() as d:\n d.process.start()\n print(d.process.pid, flush=True)\n d(Path(sys.argv[1]))\n"
    )
    asks = subprocess.Popen([sys.executable, "-c", body, str(study)], stdout=subprocess.PIPE, text=True)
    assert asks.stdout is not None
    server = int(asks.stdout.readline())
    while not (at_work := children(server)):
        time.sleep(0.01)
    asks.kill()
    asks.wait()
    asks.stdout.close()
    end = time.monotonic() + 20
    while any(running(pid) for pid in (server, *at_work)) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(running(pid) for pid in (server, *at_work))


@pytest.mark.skipif(not PROC, reason="looks for the processes in /proc")
def test_diagnoses_of_real_structures_end_when_the_one_who_asks_is_killed() -> None:
    body = f"from modalkit.papers.real import *; run_real(CASES, __import__('pathlib').Path({str(SAMPLES)!r}), None)"
    asks = subprocess.Popen([sys.executable, "-c", body])
    while not (at_work := children(asks.pid)):
        assert asks.poll() is None
        time.sleep(0.01)
    time.sleep(0.5)
    asks.kill()
    asks.wait()
    end = time.monotonic() + 10
    while any(running(pid) for pid in at_work) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(running(pid) for pid in at_work)


def running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_process_that_dies_once_is_replaced(empty: Path, tmp_path: Path) -> None:
    with Diagnoser(command=blind_stub.command("dies-once", tmp_path / "died")) as diagnoser:
        assert diagnoser(empty) == NONE


def test_a_process_that_always_dies_is_given_up(empty: Path) -> None:
    with (
        Diagnoser(command=blind_stub.command("always-dies")) as diagnoser,
        pytest.raises(EstimationError, match=r"died 3 times \(ended by SIGKILL\)"),
    ):
        diagnoser(empty)


def test_a_process_that_does_not_come_up_is_an_error(empty: Path) -> None:
    with (
        Diagnoser(command=[sys.executable, "-c", "pass"]) as diagnoser,
        pytest.raises(EstimationError, match="did not start"),
    ):
        diagnoser(empty)


def test_no_answer_on_the_disk_is_an_error(empty: Path) -> None:
    with (
        Diagnoser(command=blind_stub.command("silent")) as diagnoser,
        pytest.raises(EstimationError, match="no readable JSON"),
    ):
        diagnoser(empty)


def test_a_closed_process_is_not_started_again(empty: Path) -> None:
    diagnoser = Diagnoser(command=blind_stub.command())
    with diagnoser:
        diagnoser(empty)
    with pytest.raises(EstimationError, match="closed"):
        diagnoser(empty)
