"""Starts along a line are climbed from where they are highest; from everywhere where a line tells too little."""

from __future__ import annotations

import numpy as np
import pytest

from updating.diagnosis.search.evidence import _maxima, _on_a_line

LINES = [
    ([[0.1], [0.3], [0.9]], True),
    ([[0.1, 0.2], [0.2, 0.4], [0.3, 0.6]], True),
    ([[0.1, 0.5], [0.2, 0.5], [0.3, 0.5]], False),
    ([[0.1], [0.9], [0.3]], False),
    ([[0.1, 0.1], [0.2, 0.2], [0.3, 0.2]], False),
]


@pytest.mark.parametrize(("places", "expected"), LINES)
def test_a_line_is_straight_one_way_and_moves_every_parameter(
    places: list[list[float]], expected: bool
) -> None:
    assert _on_a_line([np.array(place) for place in places]) is expected


def test_every_top_along_a_line_is_kept_its_ends_too() -> None:
    heights = np.array([5.0, 1.0, 2.0, 7.0, 3.0, np.nan, 4.0])
    assert np.flatnonzero(_maxima(heights)).tolist() == [0, 3, 6]
    assert _maxima(np.ones(3)).all()
