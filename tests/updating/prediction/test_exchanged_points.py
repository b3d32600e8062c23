"""Two ends that changed places make strangers of the odd modes alone: pairs are found all the same."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from updating_cases import BEAM, blank, exactly

from updating import Measured, Predictor
from updating.prediction.prediction import Prediction
from updating.prediction.trusted_frfs import _macs, _promising, _swapped, trusted_rows

FREE = replace(BEAM, clamped=())
ENDS = np.linspace(0.0, 0.376, 12)
MODES = 5


def struck(swapped: tuple[int, int] | None) -> tuple[Measured, Prediction]:
    predictor = Predictor(FREE, blank(ENDS))
    truth = predictor.predict(count=MODES)
    order = np.arange(len(ENDS))
    if swapped is not None:
        order[list(swapped)] = order[list(swapped)[::-1]]
    measured = exactly(predictor, replace(truth, constants=truth.constants[order]))
    return measured, predictor.predict(count=MODES + 2)


def test_modes_are_paired_without_two_ends_that_changed_places() -> None:
    measured, prediction = struck((0, 11))
    rows = trusted_rows(measured, prediction)
    assert rows is not None
    assert set(measured.hit[~rows]) | set(measured.seen[~rows]) >= {0, 11}
    assert rows.sum() == len(ENDS) - 2


@pytest.mark.parametrize("swapped", [None, (5, 6)])
def test_points_that_hardly_matter_stay(swapped: tuple[int, int] | None) -> None:
    assert trusted_rows(*struck(swapped)) is None


def test_no_pair_of_points_is_passed_over_that_could_mend_the_shapes() -> None:
    """What an exchange is asked to reach is never held for out of reach, and most pairs are told without a trial."""
    measured, prediction = struck((0, 11))
    points = [measured.hit == point for point in range(len(ENDS))]
    pairs = list(combinations(points, 2))
    means = [float(_macs(_swapped(measured, *pair), prediction, points[0] | True).mean()) for pair in pairs]
    for pair, mean in zip(pairs, means, strict=True):
        found = _promising(measured, prediction, points, mean - 1e-9)
        assert any(one is pair[0] and two is pair[1] for one, two in found)
    best = pairs[int(np.argmax(means))]
    assert np.flatnonzero(best[0] | best[1]).tolist() == [0, 11]
    assert len(_promising(measured, prediction, points, 0.95 * max(means))) < len(pairs) / 10
