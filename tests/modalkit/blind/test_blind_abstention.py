"""What is answered against how often it is right, and what cannot be known."""

from __future__ import annotations

import numpy as np
import pytest
from blind_outcomes import diagnosis, honest_run, run_of, truth
from hypothesis import given, settings
from hypothesis import strategies as st

from modalkit.blind import score
from modalkit.blind.scoring.abstention import BOTH, KNOWN, answered_from, area, curve, right_from
from modalkit.blind.scoring.open_set import ANSWERS, AREA, HONEST, answer, roc_area, roc_curve
from modalkit.blind.scoring.table import ALL
from modalkit.figures.blind.confidence import curve_of

TRIALS = st.lists(
    st.tuples(st.sampled_from([0.1, 0.3, 0.5, 0.9, 1.0]), st.booleans()), min_size=1, max_size=12
)


@given(TRIALS)
def test_every_threshold_counts_those_at_or_above_it(trials: list[tuple[float, bool]]) -> None:
    confidence, right = np.array([c for c, _ in trials]), np.array([float(r) for _, r in trials])
    table = curve(confidence, right)
    for _, row in table.iterrows():
        over = confidence >= row["threshold"]
        assert row["committed"] == over.sum()
        assert row["count"] == right[over].sum()
        assert row["answered"] == pytest.approx(over.mean())
        assert row["low"] <= row["right"] <= row["high"]
    assert sorted(table["threshold"]) == sorted(set(confidence))


@settings(max_examples=30)
@given(TRIALS)
def test_area_is_the_mean_over_random_orders_of_ties(trials: list[tuple[float, bool]]) -> None:
    points = np.array(trials, dtype=float)
    rng = np.random.default_rng(1)
    shuffled = []
    for _ in range(400):
        some = points[rng.permutation(len(points))]
        order = np.argsort(-some[:, 0], kind="stable")
        shuffled.append((np.cumsum(some[order, 1]) / np.arange(1, len(points) + 1)).mean())
    spread = np.std(shuffled) / np.sqrt(len(shuffled))
    assert area(points[None])[0] == pytest.approx(np.mean(shuffled), abs=5 * spread + 1e-12)


def test_sure_answers_that_are_right_make_a_perfect_area() -> None:
    assert area(np.array([[[0.9, 1.0], [0.8, 1.0], [0.2, 1.0]]]))[0] == 1.0
    assert area(np.array([[[0.9, 1.0], [0.1, 0.0]]]))[0] == pytest.approx(0.75)
    assert area(np.array([[[0.1, 1.0], [0.9, 0.0]]]))[0] == pytest.approx(0.25)


def test_unknown_and_failed_commit_to_nothing_at_any_probability() -> None:
    result = score(
        run_of(
            (truth("E"), diagnosis("named", ("E",), shares=[0.97])),
            (truth("E"), diagnosis("unknown", others=[("E",)], shares=[0.99])),
            (truth("E"), None),
            (truth("taper"), diagnosis("named", ("E",), shares=[0.98])),
        )
    )
    known, both = (curve_of(result, group) for group in (KNOWN, BOTH))
    assert known.points[["committed", "count"]].to_numpy().tolist() == [[1, 1]]
    assert both.points[["committed", "count"]].to_numpy().tolist() == [[1, 0], [2, 1]]
    assert (known.right.count, known.right.total, known.answered.total) == (1, 1, 3)
    assert (both.right.count, both.right.total, both.answered.total) == (1, 2, 4)
    rows = [result.rates[question(0.95), BOTH] for question in (answered_from, right_from)]
    assert [(row.count, row.total) for row in rows] == [(2, 4), (1, 2)]


def test_no_effect_is_a_set_of_its_own() -> None:
    result = score(run_of((truth(), diagnosis("none", others=[("E",)], shares=[0.3]))))
    assert result.trials["confidence"].tolist() == pytest.approx([0.7])
    assert result.trials["first"].tolist() == [True]


def test_names_of_the_same_change_add_their_probabilities() -> None:
    both = diagnosis("class", ("calibration_gain",), ("section_scale",), shares=[0.49, 0.5])
    hidden = truth("section_scale", accepted=(("calibration_gain",), ("section_scale",)))
    result = score(run_of((hidden, both)))
    assert result.trials["confidence"].tolist() == pytest.approx([0.99])
    assert result.trials[["commits", "holds", "first"]].all(axis=None)


def test_a_false_name_takes_no_part_in_the_merit_of_a_true_one() -> None:
    both = diagnosis("named", ("exponential_window",), others=[("uniform_damping",)], shares=[0.97, 0.02])
    result = score(run_of((truth("uniform_damping"), both)))  # damping that a window cannot make
    assert result.trials["confidence"].tolist() == pytest.approx([0.97])
    assert result.trials["probability"].tolist() == pytest.approx([0.02])
    assert not result.trials["first"].any() and not curve_of(result, KNOWN).points["right"].any()


@pytest.mark.long
def test_waiting_longer_pays_where_probabilities_are_honest() -> None:
    result = score(honest_run(1200, 11))
    least = curve_of(result, KNOWN).points.iloc[-1]
    assert result.rates[right_from(0.95), KNOWN].rate > least["right"] + 0.1
    assert result.rates[answered_from(0.95), KNOWN].rate < least["answered"]


def test_roc_area_is_the_share_of_pairs_in_order() -> None:
    rng = np.random.default_rng(2)
    value, positive = rng.integers(0, 5, 40) / 4.0, (rng.random(40) < 0.4).astype(float)
    pairs = [
        float(value[i] > value[j]) + 0.5 * float(value[i] == value[j])
        for i in np.flatnonzero(positive)
        for j in np.flatnonzero(1 - positive)
    ]
    found = roc_area(np.column_stack([value, positive])[None])[0]
    assert found == pytest.approx(np.mean(pairs))
    table = roc_curve(value, positive)
    across, up = np.r_[0, table["false"]], np.r_[0, table["found"]]
    assert np.trapezoid(up, across) == pytest.approx(found)


def test_unknowable_effects_are_counted_by_name() -> None:
    result = score(
        run_of(
            (truth("taper"), diagnosis("unknown", fit=0.001, others=[("E",)])),
            (truth("taper"), diagnosis("named", ("thickness",), fit=0.4)),
            (truth("ground_spring"), diagnosis("class", ("E",), ("length",), fit=0.002)),
            (truth("taper", visibility=1.0), diagnosis("none")),
            (truth("E", without=("E",), accepted=(("density",),)), diagnosis("named", ("density",))),
            (truth("E"), diagnosis("named", ("E",), fit=0.9)),
        )
    )
    found = result.rates
    honest = found[HONEST, "all, outside"]
    assert (honest.count, honest.total) == (1, 3)
    of_taper = [found[answer(name), "taper (outside)"].count for name in ANSWERS]
    assert dict(zip(ANSWERS, of_taper, strict=True)) == {
        "unknown": 1, "equivalent": 0, "wrong name": 1, "wrong class": 0, "none": 0, "failed": 0
    }  # fmt: skip
    assert sum(of_taper) == found[HONEST, "taper (outside)"].total
    assert found[answer("wrong class"), "ground_spring (outside)"].count == 1
    assert found[answer("equivalent"), "E (left out)"].count == 1
    assert found[HONEST, "E (left out)"].rate == 1.0
    assert found[AREA, ALL].rate == 1.0
