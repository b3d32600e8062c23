"""How long work will still take, by what it took before."""

from __future__ import annotations

from pathlib import Path

import pytest

from modalkit.app.times import keep, kept, remaining

BEFORE = [("reading", 2.0), ("comparing", 4.0), ("writing", 24.0), ("done", 30.0)]


@pytest.mark.parametrize(
    ("now", "seconds", "left"),
    [
        ([], 1.0, 29.0),
        ([("reading", 2.0)], 3.0, 27.0),
        ([("reading", 2.0), ("comparing", 4.0)], 14.0, 16.0),
        ([("reading", 2.0), ("comparing", 8.0)], 18.0, 2 * 20.0 - 10.0 + 2 * 6.0),  # half as fast as before
        ([("reading", 2.0), ("comparing", 4.0)], 50.0, 6.0),  # longer than before: what follows is left
        ([("planning", 2.0)], 3.0, 27.0),  # a stage that is new
    ],
)
def test_what_is_left_follows_from_the_last_time(now, seconds: float, left: float | None) -> None:
    assert remaining(now, seconds, BEFORE) == (None if left is None else pytest.approx(left))


def test_without_a_last_time_nothing_is_stated(tmp_path: Path) -> None:
    file = tmp_path / "times.json"
    assert remaining([], 1.0, kept(file, "update")) is None
    keep(file, "update", BEFORE[:-1], 30.0)
    keep(file, "diagnose", [], 1.0)
    assert kept(file, "update") == BEFORE
    file.write_text('{"update": 3}', encoding="utf-8")
    assert kept(file, "update") == []
    keep(file, "update", BEFORE[:-1], 30.0)
    assert kept(file, "update") == BEFORE
