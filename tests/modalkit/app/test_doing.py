"""What is computed is named, timed and stopped, and nothing of it is kept."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

from modalkit.app.doing import Doing, Stopped
from modalkit.app.kept import Kept
from modalkit.app.times import keep, kept


def test_the_innermost_step_is_stated_with_its_time(tmp_path: Path) -> None:
    times = tmp_path / "times.json"
    doing = Doing(times)
    keep(times, "identifying", [], 20.0)
    assert doing.document()["what"] == ""
    with doing.step("reading"):
        assert doing.document()["remaining_s"] is None
        with doing.step("identifying"):
            found = doing.document()
        assert doing.document()["what"] == "reading"
    assert found["what"] == "identifying"
    assert found["remaining_s"] == pytest.approx(20.0, abs=1.0)
    assert doing.document()["what"] == ""


def test_stages_are_stated_and_kept_for_the_next_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    times = tmp_path / "times.json"
    keep(times, "identifying", [("poles", 0.0), ("fit", 5.0)], 20.0)
    clock = iter(range(0, 1000, 2))
    monkeypatch.setattr(time, "monotonic", lambda: float(next(clock)))
    doing = Doing(times)
    doing.stage("poles")
    assert doing.document()["what"] == ""
    with doing.step("identifying"):
        doing.stage("poles")
        assert doing.document() == {"what": "identifying: poles", "seconds": 4.0, "remaining_s": 3.0 + 15.0}
        doing.stage("fit")
        assert doing.document()["what"] == "identifying: fit"
    assert [name for name, _ in kept(times, "identifying")] == ["poles", "fit", "done"]


def endless() -> int:
    number = 0
    while True:
        number += 1


def test_a_stop_ends_what_is_computed_and_leaves_nothing(tmp_path: Path) -> None:
    doing = Doing(tmp_path / "times.json")
    results: Kept[int] = Kept(2, lambda: doing.step("computing"))
    ends: list[BaseException] = []

    def compute() -> None:
        try:
            results.get("key", endless)
        except Stopped as stopped:
            ends.append(stopped)

    thread = threading.Thread(target=compute, daemon=True)
    thread.start()
    while not doing.document()["what"]:
        time.sleep(0.01)
    doing.stop()
    thread.join(10.0)
    assert not thread.is_alive()
    assert len(ends) == 1
    assert doing.document()["what"] == ""
    assert results.get("key", lambda: 3) == 3
    doing.stop()  # nothing is computed: nobody is stopped
    assert results.get("other", lambda: 4) == 4


def test_a_stop_at_the_end_is_raised_inside_or_not_at_all(tmp_path: Path) -> None:
    """Short steps, stopped at any time: each is either finished or stopped, and the thread goes on."""
    doing = Doing(tmp_path / "times.json")
    counts = {"finished": 0, "stopped": 0}
    done = threading.Event()

    def compute() -> None:
        for _ in range(3000):
            try:
                with doing.step("computing"):
                    sum(range(50))
                counts["finished"] += 1
            except Stopped:
                counts["stopped"] += 1
        done.set()

    thread = threading.Thread(target=compute, daemon=True)
    thread.start()
    while not done.is_set():
        doing.stop()
        time.sleep(0.0005)
    thread.join(10.0)
    assert counts["finished"] + counts["stopped"] == 3000
    assert doing.document()["what"] == ""
