"""Whether the score finds honest probabilities honest, and others not."""

from __future__ import annotations

import numpy as np
import pytest
from blind_outcomes import diagnosis, honest_run, run_of, truth
from hypothesis import given
from hypothesis import strategies as st

from modalkit.blind import score
from modalkit.blind.answer import read_answer
from modalkit.blind.scoring.calibration import (
    BELOW,
    BIAS,
    CAME_TRUE,
    EDGES,
    ERROR,
    HOLDS,
    OVER,
    SIZES,
    STATED,
    UNIFORM,
    bins,
    calibration_error,
    of_size,
    reliability,
)
from modalkit.blind.scoring.posterior import posterior
from modalkit.blind.scoring.table import ALL


def test_brier_and_log_score_by_hand() -> None:
    message = diagnosis("class", ("E",), ("density",), others=[("length",)], shares=[0.6, 0.3, 0.05])
    stated = posterior(read_answer(message), truth("density"))
    assert stated.brier == pytest.approx(0.6**2 + 0.7**2 + 0.05**2 + 0.05**2)
    assert stated.truth == pytest.approx(0.3)
    trials = score(run_of((truth("density"), message))).trials
    assert trials["log"].tolist() == pytest.approx([-np.log(0.3)])


def test_smallest_set_that_holds_95_percent() -> None:
    shares = [0.6, 0.3, 0.06, 0.04]
    rows = [("E",), ("density",), ("length",), ("shear",)]
    message = read_answer(diagnosis("class", *rows[:3], others=rows[3:], shares=shares))
    assert posterior(message, truth("length")).credible() == (3, True)
    assert posterior(message, truth("shear")).credible() == (3, False)
    assert posterior(message, truth("shear")).credible(0.99) == (4, True)
    assert posterior(message, truth("E")).credible(0.5) == (1, True)


def test_a_truth_that_was_not_compared_has_no_probability() -> None:
    trials = score(run_of((truth("E"), diagnosis("named", ("density",), shares=[1.0])))).trials
    assert trials["brier"].tolist() == pytest.approx([2.0])
    assert trials["log"].tolist() == pytest.approx([-np.log(1e-6)])
    assert not trials["covers"].any()


@given(st.lists(st.floats(0, 1), min_size=1, max_size=50))
def test_every_probability_has_one_bin(stated: list[float]) -> None:
    place = bins(np.array(stated))
    for value, i in zip(stated, place, strict=True):
        assert EDGES[i] <= value <= EDGES[i + 1]
    rows = list(reliability(np.array(stated), np.ones(len(stated))))
    true, mean = ([row for row in rows if row.question == question] for question in (CAME_TRUE, STATED))
    assert sum(row.total for row in true) == len(stated)
    assert [row.group for row in true] == [row.group for row in mean]
    edges = [(EDGES[i], EDGES[i + 1]) for i in sorted(set(place))]
    for (low, high), row in zip(edges, mean, strict=True):
        assert low - 1e-12 <= row.rate <= high + 1e-12


def test_expected_calibration_error_by_hand() -> None:
    points = np.array([[0.85, 1.0], [0.85, 0.0], [0.3, 0.0], [0.3, 0.0]])
    assert calibration_error(points[None])[0] == pytest.approx(0.5 * 0.35 + 0.5 * 0.3)
    assert calibration_error(points[None, [0, 0, 0, 0]])[0] == pytest.approx(0.15)


@pytest.mark.long
def test_honest_probabilities_pass_and_cover() -> None:
    found = score(honest_run(2000, 21)).rates
    bias = found[BIAS, "effects and none, faint ones too"]
    visible = found[BIAS, "visible effects"]
    assert visible.low < 0.02 and visible.high > -0.02
    assert found[ERROR, "visible effects"].rate < 0.05
    cover = found.of(HOLDS)[0]
    assert cover.low < 0.985 and cover.rate > 0.94
    sizes = [*(of_size(n) for n in SIZES), OVER]
    assert cover.total == sum(found[size, cover.group].count for size in sizes)
    assert bias.total > visible.total


def test_overconfident_probabilities_are_found_out() -> None:
    wrong = [(truth("E"), diagnosis("named", ("density",), others=[("E",)], shares=[0.98, 0.02]))] * 6
    right = [(truth("E"), diagnosis("named", ("E",), others=[("density",)], shares=[0.98, 0.02]))] * 6
    found = score(run_of(*wrong, *right)).rates[ERROR, "visible effects"]
    assert found.rate == pytest.approx(0.48)
    assert found.low > 0.1


def test_p_value_where_nothing_is_hidden() -> None:
    values = (np.arange(40) + 0.5) / 40
    even = score(run_of(*((truth(), diagnosis("none", p_value=p)) for p in values))).rates
    assert [row.rate for row in even.of(BELOW)] == pytest.approx([0.0, 0.05, 0.25, 0.5, 0.75, 0.95])
    assert [row.group for row in even.of(BELOW)] == ["0.005", "0.05", "0.25", "0.5", "0.75", "0.95"]
    assert even[UNIFORM, ALL].rate > 0.99
    small = score(run_of(*((truth(), diagnosis("none", p_value=p**4)) for p in values))).rates
    assert small[UNIFORM, ALL].rate < 1e-3
