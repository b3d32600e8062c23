"""What a caller learns of a diagnosis while it goes on."""

from __future__ import annotations

from updating.steps import SILENT, Steps


def test_parts_follow_the_cost_of_what_is_past() -> None:
    parts: list[float] = []
    assert list(Steps(done=parts.append).each(["a", "b", "c"], [1.0, 1.0, 2.0])) == ["a", "b", "c"]
    assert parts == [0.0, 0.25, 0.5]
    assert list(SILENT.each([], [])) == []
    parts.clear()
    assert list(Steps.to(None, parts.append).each(range(4))) == [0, 1, 2, 3]
    assert parts == [0.0, 0.25, 0.5, 0.75]
