"""The score, on outcomes whose counts are known by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from blind_outcomes import diagnosis, honest_run, interval, outcome, run_of, truth
from conforming import departures
from scipy.stats import binomtest
from scipy.stats import bootstrap as scipy_bootstrap

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from modalkit.blind import BlindResult, DrawRanges, Truth, score
from modalkit.blind.answer import read_answer
from modalkit.blind.scoring.closing import BEYOND, INSIDE, MET, MISSED
from modalkit.blind.scoring.intervals import RESAMPLES, bootstrap, wilson
from modalkit.blind.scoring.judge import commits, credit, holds, is_right, top_is_right
from modalkit.blind.scoring.markdown import BEGIN, END, into_page, score_markdown
from modalkit.blind.scoring.places import CHANNEL
from modalkit.blind.scoring.rates import SETS, TOP, TRUE_OF_SHOWN, headline, questions
from modalkit.blind.scoring.score import score_again
from modalkit.blind.scoring.table import ALL
from modalkit.blind.shrunk import Shrinkage
from modalkit.cli.scores import show_score, write_markdown
from modalkit.output.schemas import BlindDocument


@pytest.mark.parametrize(
    ("hidden", "message", "right", "top"),
    [
        (truth("E"), diagnosis("named", ("E",)), True, True),
        (truth("E"), diagnosis("named", ("density",)), False, False),
        (truth("E"), diagnosis("class", ("density",), ("E",)), True, False),
        (truth("E"), diagnosis("named", ("E", "length")), False, False),
        (truth("E"), diagnosis("none"), False, False),
        (truth("E"), diagnosis("unknown", others=[("E",)]), False, False),
        (truth("sensor_mass"), diagnosis("named", ("lumped_mass",)), True, True),
        (truth("length", "E"), diagnosis("named", ("E", "length")), True, True),
        (truth("length", "E"), diagnosis("named", ("E",)), False, False),
        (truth(), diagnosis("none", others=[("E",)]), True, True),
        (truth(), diagnosis("unknown"), False, False),
        (truth(), diagnosis("named", ("E",)), False, False),
        (truth("taper"), diagnosis("unknown", others=[("E",)]), True, True),
        (truth("taper"), diagnosis("named", ("thickness",)), False, False),
        (truth("E", without=("E",)), diagnosis("unknown"), True, True),
        (truth("E", without=("E",)), diagnosis("named", ("density",)), False, False),
        (truth("E", without=("E",), accepted=(("density",),)), diagnosis("named", ("density",)), True, True),
        (truth("taper", accepted=(("thickness",),)), diagnosis("named", ("thickness",)), True, True),
    ],
)
def test_judgement(hidden: Truth, message: dict[str, Any], right: bool, top: bool) -> None:
    answer = read_answer(message)
    assert is_right(answer, hidden) == right
    assert top_is_right(answer, hidden) == top


def test_pair_that_contains_the_truth_does_not_hold_it() -> None:
    pair = read_answer(diagnosis("class", ("E", "length"), ("thickness", "length")))
    assert not holds(pair, truth("E"))


def test_a_class_earns_the_chance_of_a_blind_pick() -> None:
    of_three = diagnosis("class", ("E",), ("density",), ("length",), others=[("shear",)])
    assert credit(read_answer(of_three), truth("E")) == pytest.approx(1 / 3)
    assert credit(read_answer(of_three), truth("shear")) == 0.0
    both = diagnosis("class", ("sensor_mass",), ("lumped_mass",), others=[("E",)])
    assert credit(read_answer(both), truth("sensor_mass")) == 1.0


def test_a_class_that_lists_everything_earns_nothing() -> None:
    everything = read_answer(diagnosis("class", ("E",), ("density",), ("length",)))
    assert credit(everything, truth("E")) == 0.0
    assert is_right(everything, truth("E"))


def test_names_of_the_same_change_are_one_answer() -> None:
    assert commits(read_answer(diagnosis("class", ("calibration_gain",), ("section_scale",))))
    assert commits(read_answer(diagnosis("class", ("E", "exponential_window"), ("E", "uniform_damping"))))
    assert not commits(read_answer(diagnosis("class", ("E",), ("density",))))
    assert not commits(read_answer(diagnosis("none")))


def by_hand() -> BlindResult:
    factor = {"E.factor": interval(1.1, 1.05, 1.15)}
    return run_of(
        (truth("E", factor=1.12), diagnosis("named", ("E",), parameters=factor)),
        (truth("E", factor=1.30), diagnosis("named", ("E",), parameters=factor)),
        (truth("E"), diagnosis("class", ("density",), ("E",), others=[("length",)])),
        (truth("density"), diagnosis("named", ("E",))),
        (truth("density", visibility=1.0), diagnosis("none")),
        (truth("length"), diagnosis("class", ("E",), ("density",))),
        (truth("length"), None),
        (truth(), diagnosis("none")),
        (truth(), diagnosis("named", ("E",))),
        (truth("taper"), diagnosis("unknown")),
        (truth("ground_spring"), diagnosis("named", ("clamp_rotation",))),
        (truth("E", "length"), diagnosis("named", ("E", "length"))),
        (truth("E", without=("E",)), diagnosis("class", ("density",), ("length",))),
    )


def test_rates_are_counted_as_by_hand() -> None:
    result = score(by_hand())
    counts = {q: (result.rates[q, ALL].count, result.rates[q, ALL].total) for q in questions(result.trials)}
    outside, left = "effect outside the library", "effect left out of the library"
    assert counts == {
        "most probable answer is the truth": (4, 9),
        "answer is true (named, in the class, or none)": (5, 9),
        "a class counted by its share": (4.5, 9),
        "most probable answer is the truth, one effect": (2, 6),
        "most probable answer is the truth, a pair": (1, 1),
        "commits to one answer": (4, 7),
        "right when it commits": (3, 6),
        "right when it commits, effect of the library": (3, 4),
        "class holds the truth": (1, 2),
        "right when it names or gives a class": (4, 6),
        "visible effect called none": (0, 7),
        "visible effect called unknown": (0, 7),
        "faint effect: true answer or none": (1, 1),
        "faint effect called none": (1, 1),
        "false alarm on none": (1, 2),
        "false name on none": (1, 2),
        "diagnosis failed": (1, 13),
        f"{outside}: unknown or an honest equivalent": (1, 2),
        f"{outside}: unknown": (1, 2),
        f"{outside}: wrong name": (1, 2),
        f"{outside}: wrong class": (0, 2),
        f"{outside}: called none": (0, 2),
        f"{left}: unknown or an honest equivalent": (0, 1),
        f"{left}: unknown": (0, 1),
        f"{left}: wrong name": (0, 1),
        f"{left}: wrong class": (1, 1),
        f"{left}: called none": (0, 1),
    }
    inside = headline(result.rates)["parameter inside its 95 % interval"]
    assert (inside.count, inside.total) == (1, 2)


def test_confusion_shares_a_class_among_its_sets() -> None:
    result = score(by_hand())
    confusion = result.to_json()["confusion"]
    assert confusion["E"]["density"] == 1.0  # half of two classes, one of them left out
    assert confusion["length"]["failed"] == 1.0
    assert confusion["E + length"]["E + length"] == 1.0
    assert confusion["none"]["none"] == 1.0
    assert sum(sum(row.values()) for row in confusion.values()) == pytest.approx(13)
    true = result.answers[result.answers["true"].astype(bool)]
    assert true["share"].sum() == pytest.approx(5.5)


def test_effects_are_counted_by_what_became_of_them() -> None:
    found = score(by_hand()).rates

    def counts(effect: str, *names: str) -> list[float]:
        return [found[f"effect: {name}", effect].count for name in names]

    assert counts("E", "named right", "class with it", "wrong") == [2, 1, 0]
    assert counts("E (left out)", "named right", "class with it", "wrong") == [0, 0, 1]
    assert found[SETS, "E"].rate == pytest.approx(4 / 3)
    assert counts("density", "visible", "none") == [1, 1]
    assert (found[TRUE_OF_SHOWN, "density"].rate, found[TRUE_OF_SHOWN, "density"].total) == (0.0, 1)
    assert sum(row.total for row in found.of("effect: visible")) == 13


def test_groups_split_what_is_asked() -> None:
    result = score(
        run_of(
            (truth("E", level="mild", kind="plate", baseline=True), diagnosis("named", ("E",))),
            (truth("E", level="mild"), diagnosis("named", ("length",))),
            (truth("E", level="strong"), diagnosis("named", ("E",))),
            (truth("E", level="mild", visibility=1.0), diagnosis("none")),
        )
    ).rates
    mild, strong = result[TOP, "level: mild"], result[TOP, "level: strong"]
    assert (mild.total, mild.rate) == (2, 0.5)
    assert (strong.total, strong.rate) == (1, 1.0)
    assert result[TOP, "kind: plate"].total == 1
    assert result[TOP, "baseline: yes"].rate == 1.0


def test_places_take_the_nearest_of_mirrored_ones_and_the_first() -> None:
    message = diagnosis("named", ("local_stiffness",), locations=[[0.4, 0, 0], [0.11, 0, 0]])
    result = score(run_of((truth("local_stiffness", x=0.1, places=((0.1,),)), message)))
    assert result.places["nearest"].tolist() == pytest.approx([0.01 / 0.5])
    assert result.places["first"].tolist() == pytest.approx([0.3 / 0.5])
    assert result.places["places"].tolist() == [2]


def test_places_of_plates_are_over_the_diagonal() -> None:
    message = diagnosis("named", ("lumped_mass",), locations=[[0.13, 0.24, 0]])
    hidden = truth("lumped_mass", places=((0.1, 0.2),), size=(0.3, 0.4), kind="plate")
    assert score(run_of((hidden, message))).places["nearest"].tolist() == pytest.approx([0.1])


def test_severity_comes_from_the_row_of_the_hidden_effect() -> None:
    message = diagnosis("class", ("density",), ("E",))
    message["cause"]["ranking"][1]["parameters"] = {"E.factor": interval(1.32, 1.2, 1.4)}
    message["cause"]["ranking"][0]["parameters"] = {"density.factor": interval(0.8, 0.7, 0.9)}
    table = score(run_of((truth("E", factor=1.2), message))).severity
    assert table["parameter"].tolist() == ["E.factor"]
    assert table["error"].tolist() == pytest.approx([0.1])
    assert table["covered"].tolist() == [True]


def test_of_a_soft_place_the_compliance_counts_and_not_what_makes_it() -> None:
    names = ("extent", "extent_y", "loss", "compliance")
    message = diagnosis("named", ("local_stiffness",))
    stated = {f"local_stiffness.{name}": interval(0.1, 0.05, 0.2) for name in names}
    message["cause"]["ranking"][0]["parameters"] = stated
    hidden = truth("local_stiffness", kind="plate", **dict.fromkeys(names, 0.1))
    assert score(run_of((hidden, message))).severity["parameter"].tolist() == ["local_stiffness.compliance"]


def test_points_are_right_only_together() -> None:
    message = diagnosis(
        "named", ("polarity",), parameters={"polarity.points": {"value": [3, 2], "unit": "node"}}
    )
    message["cause"]["ranking"][0]["parameters"]["polarity.points"] |= {"low95": None, "high95": None}
    table = score(
        run_of((truth("polarity", points=[2, 3]), message), (truth("polarity", points=[2]), message))
    ).points
    assert table["same"].tolist() == [True, False]


def test_channel_may_be_that_of_an_equivalent() -> None:
    message = [
        diagnosis("named", ("uniform_damping",), channel=c) for c in ("damping", "measurement", "mass")
    ]
    row = score(run_of(*((truth("exponential_window"), s) for s in message))).rates[CHANNEL, ALL]
    assert (row.count, row.total) == (2, 3)


def test_shrinkage_is_compared_where_both_speak_of_the_same() -> None:
    message = diagnosis("named", ("E",), closed=interval(95.0, 90.0, 100.0))
    trials = (
        outcome(
            0, truth("E"), message, Shrinkage("frequency", 5.0, 1.0, 4.0, 2.0)
        ),  # closes 96 %, above the band 75 %
        outcome(1, truth("E"), message, Shrinkage("frequency", 5.0, 2.5, 4.0, 2.0)),  # closes 75 %
        outcome(2, truth("E"), message, Shrinkage("damping", 5.0, 2.5, 4.0, 2.0)),
        outcome(3, truth("E"), message),
    )
    result = score(BlindResult(7, DrawRanges(), trials))
    assert result.rates[MISSED, ALL].rate == pytest.approx((1 + 20) / 2)
    for question in (MET, INSIDE):
        assert (result.rates[question, ALL].count, result.rates[question, ALL].total) == (1, 2)
    assert result.rates[BEYOND, ALL].rate == pytest.approx(75)
    assert result.closing["held_out"].iloc[0] == pytest.approx(100 * (1 - (0.25 - 0.01) / (25 - 0.01)))


def test_json_is_strict_whole_and_can_be_scored_again() -> None:
    first = score(honest_run(60, 3)).to_json()
    text = json.dumps(first, allow_nan=False)
    back = json.loads(text)
    assert back["schema"] == "modalkit.blind/2"
    assert not departures(back, BlindDocument)
    again = json.loads(json.dumps(score_again(back).to_json(), allow_nan=False))
    assert again == back
    assert json.loads(json.dumps(score_again(back | {"schema": "modalkit.blind/1"}).to_json())) == back
    assert len({row["salt"] for row in back["outcomes"]}) == 60
    for other in ("modalkit.modes/1", "modalkit.blind/3"):
        with pytest.raises(InputError, match=r"neither modalkit\.blind/2 nor"):
            score_again(back | {"schema": other})


def test_score_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="no trials"):
        score(BlindResult(1, DrawRanges(), ()))


@pytest.mark.parametrize(
    "pairs",
    [
        [(truth(), diagnosis("none"))],
        [(truth("taper"), diagnosis("unknown"))],
        [(truth("E"), None)],
        [(truth("E"), diagnosis("named", ("E",)))],
    ],
)
def test_one_trial_of_each_sort_can_be_scored_and_told(pairs: list[tuple[Truth, Any]]) -> None:
    result = score(run_of(*pairs))
    assert "What matters first" in score_markdown(result)
    json.dumps(result.to_json(), allow_nan=False)


def test_markdown_stands_between_its_marks_and_leaves_the_page_alone() -> None:
    result = score(by_hand())
    page = f"# Blind\n\n{BEGIN}\nOUTDATED\n{END}\n\nThe end.\n"
    new = into_page(page, result)
    assert new.startswith("# Blind\n") and new.endswith("The end.\n") and "OUTDATED" not in new
    assert into_page(new, result) == new
    rows = [line for line in new.splitlines() if line.startswith("| false alarm")]
    assert rows[0].endswith("| 1 of 2 |")
    widths = [line.count("|") - line.count("\\|") for line in new.splitlines() if line.startswith("|")]
    assert min(widths) > 2


def test_printed_score_begins_with_what_matters_and_ends_with_what_failed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    show_score(score(by_hand()))
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "What matters first"
    assert lines[1].startswith(
        "13 trials, seed 7: 10 effects that the data show, 1 faint ones, 2 without any"
    )
    assert any(line.startswith("right when it commits ") and "3 of 4" in line for line in lines[:14])
    assert lines[-1] == "failed: trial 6 (length): EstimationError: broken"


def test_markdown_file_is_made_or_filled_between_its_marks(tmp_path: Path) -> None:
    result = score(by_hand())
    plain, page = tmp_path / "score.md", tmp_path / "blind.md"
    page.write_text(f"# Blind\n{BEGIN}\n{END}\nThe end.\n", encoding="utf-8")
    for path in (plain, page):
        write_markdown(path, result)
    assert plain.read_text(encoding="utf-8") == score_markdown(result, level=2)
    assert page.read_text(encoding="utf-8").startswith("# Blind\n")
    assert score_markdown(result) in page.read_text(encoding="utf-8")


def test_docs_have_the_marks_for_the_released_score() -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "trust" / "blind_score.md").read_text(
        encoding="utf-8"
    )
    assert page.count(BEGIN) == page.count(END) == 1


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_counts_do_not_depend_on_the_order_of_the_trials(seed: int) -> None:
    run = honest_run(80, seed)
    back = BlindResult(run.seed, run.plan, run.outcomes[::-1])
    one, other = score(run), score(back)
    tables = (table.frame().sort_values(["question", "group"]) for table in (one.rates, other.rates))
    shares = [table[table["count"].notna()].reset_index(drop=True) for table in tables]
    pd.testing.assert_frame_equal(*shares)
    confusion, again = (found.to_json()["confusion"] for found in (one, other))
    for name, row in confusion.items():
        assert row == pytest.approx(again[name])
    trials = one.trials["effect"].value_counts().to_dict()
    assert {name: sum(row.values()) for name, row in confusion.items()} == pytest.approx(trials)


def test_better_answers_never_score_less() -> None:
    run = by_hand()
    answered = list(run.outcomes)
    answered[3] = outcome(3, answered[3].truth, diagnosis("named", ("density",)))
    before, after = score(run), score(BlindResult(7, run.plan, tuple(answered)))
    for question in (
        "most probable answer is the truth",
        "a class counted by its share",
        "right when it commits",
    ):
        assert after.rates[question, ALL].rate > before.rates[question, ALL].rate


def test_several_hidden_places_are_compared_with_as_many() -> None:
    message = diagnosis("named", ("polarity",), locations=[[0.2, 0, 0], [0.4, 0, 0], [0.3, 0, 0]])
    table = score(run_of((truth("polarity", points=[1, 3], places=((0.4,), (0.2,))), message))).places
    assert table[["nearest", "first"]].to_numpy().tolist() == [[0.0, 0.0]]


@pytest.mark.parametrize(("count", "total"), [(0, 10), (5, 10), (10, 10), (0, 1), (999, 1000)])
def test_wilson_interval_of_whole_counts_is_scipys(count: int, total: int) -> None:
    assert wilson(count, total) == pytest.approx(binomtest(count, total).proportion_ci(method="wilson"))


def test_wilson_interval_of_fractions_lies_between_those_of_whole_counts() -> None:
    low, high = wilson([2, 2.5, 3], [10, 10, 10])
    assert low[0] < low[1] < low[2]
    assert high[0] < high[1] < high[2]
    assert np.isnan(wilson(0, 0)).all()


def test_bootstrap_interval_of_a_mean_is_scipys_of_the_same_draws() -> None:
    values = np.random.default_rng(4).normal(3.0, 2.0, 400)
    found = bootstrap(values, np.random.default_rng(5))
    theirs = scipy_bootstrap(
        (values,), np.mean, n_resamples=RESAMPLES, method="percentile", random_state=np.random.default_rng(5)
    ).confidence_interval
    assert found == pytest.approx((values.mean(), theirs.low, theirs.high))


def test_bootstrap_leaves_out_samples_in_which_the_statistic_is_not_defined() -> None:
    def of_any(values: FloatArray) -> FloatArray:
        return np.where(values.any(axis=1), 2.0, np.nan)

    found = bootstrap(np.array([0.0, 1.0]), np.random.default_rng(5), statistic=of_any)
    assert found[1:] == (2.0, 2.0)
    alone = bootstrap(np.array([7.0]), np.random.default_rng(5))
    assert alone == (7.0, 7.0, 7.0)
