"""What long commands show while they work: stage, part, time left, in a terminal and where stderr is piped."""

from __future__ import annotations

import ast
import io
import re
import time
from pathlib import Path

import pytest
from rich.console import Console

from modalkit.cli import progress as shown
from modalkit.cli.progress import Work, reading, working
from modalkit.output.durations import duration
from modalkit.workflow import stages as names
from modalkit.workflow.identification import read_frfs

ROOT = Path(__file__).resolve().parents[3]


class Clock:
    """A clock that is set by hand [s]."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_durations_are_read_at_a_glance() -> None:
    seconds = (0.4, 59, 60, 75, 3599.6, 3600, 4320)
    assert list(map(duration, seconds)) == [
        "0 s", "59 s", "1 min", "1 min 15 s", "1 h", "1 h", "1 h 12 min",
    ]  # fmt: skip


def test_a_line_states_part_and_time_left() -> None:
    clock = Clock()
    work = Work("reading the files", clock)
    assert work.line() == "reading the files (0 s so far)"
    clock.now = 5.0
    work.begin("comparing single causes")
    clock.now = 15.0
    work.done(0.25)
    assert work.line() == "comparing single causes, 25 %, about 30 s left in this stage (15 s so far)"
    clock.now = 20.0  # time passes and nothing more is done
    assert work.left == 45.0
    clock.now = 500.0
    work.begin("choosing the next test")
    assert work.line() == "choosing the next test (8 min 20 s so far)"


def test_pieces_are_counted() -> None:
    clock = Clock()
    work = Work("blind trials", clock)
    finished = work.counter(8)
    assert work.line() == "blind trials, 0 of 8, 0 % (0 s so far)"
    clock.now = 30.0
    finished("an outcome")
    finished()
    assert work.line() == "blind trials, 2 of 8, 25 %, about 1 min 30 s left (30 s so far)"


@pytest.fixture
def piped(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    text = io.StringIO()
    monkeypatch.delenv(shown.SWITCH, raising=False)
    monkeypatch.setattr(shown, "EVERY", 0.05)
    monkeypatch.setattr(shown, "progress", Console(file=text, width=30))
    return text


def test_a_pipe_has_a_line_at_every_interval(piped: io.StringIO) -> None:
    with reading("identifying") as work:
        work.read(0.5)
        time.sleep(0.2)
        work.read(1.0)
        time.sleep(0.2)
    lines = piped.getvalue().splitlines()
    assert len(lines) >= 2
    assert lines[0].startswith("reading the files, 50 %") and lines[-1].startswith("identifying (")


def test_short_work_and_switched_off_work_write_nothing(
    piped: io.StringIO, monkeypatch: pytest.MonkeyPatch
) -> None:
    with working("reading"):
        pass
    monkeypatch.setenv(shown.SWITCH, "off")
    with working("reading"):
        time.sleep(0.2)
    assert piped.getvalue() == ""


def test_a_closed_pipe_does_not_stop_the_work(piped: io.StringIO) -> None:
    with working("reading"):
        piped.close()
        time.sleep(0.2)


def test_a_terminal_has_one_line_that_is_gone_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    text = io.StringIO()
    monkeypatch.delenv(shown.SWITCH, raising=False)
    monkeypatch.setattr(shown, "progress", Console(file=text, width=80, force_terminal=True))
    with working("reading") as work:
        work.begin("comparing pairs of causes")
        work.done(0.4)
        time.sleep(0.3)
    assert "comparing pairs of causes, 40 %" in text.getvalue()
    assert not text.getvalue().endswith("so far)")


def test_app_and_terminal_use_one_word_for_one_stage() -> None:
    known = {value for name, value in vars(names).items() if name.isupper()}
    tree = ast.parse((ROOT / "modalkit" / "app" / "work.py").read_text(encoding="utf-8"))
    named = [
        call.args[0].value
        for call in ast.walk(tree)
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name)
        and call.func.id == "progress"
        and isinstance(call.args[0], ast.Constant)
    ]
    assert named and set(named) <= known


def test_an_identification_names_its_stages() -> None:
    stages: list[str] = []
    read_frfs(ROOT / "sample_data" / "beam_dry" / "beam_dry.uff").identify(
        band=(5.0, 500.0), progress=stages.append
    )
    assert stages[0] == "estimating poles" and stages[-1] == "estimating standard deviations"
    assert any(re.fullmatch(r"fitting \d+ candidates to 5 FRFs", stage) for stage in stages)
