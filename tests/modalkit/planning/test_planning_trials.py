"""A forecast checked by trials on the rig that it speaks of: the advice, when followed, separates what was not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from modalkit.blind.answer import Answer
from modalkit.planning import forecast
from modalkit.planning.case import Case
from modalkit.planning.cases import choose
from modalkit.planning.forecast import Advice, Forecast
from modalkit.planning.own import OwnBench, bench_of
from modalkit.planning.separability import SEEN
from modalkit.planning.trials import Tried, check
from modalkit.simulation.simulate import simulate_test
from modalkit.study.named_effects import effects_text
from modalkit.study.read import read_study

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"


@pytest.fixture(scope="module")
def bench() -> OwnBench:
    return bench_of(read_study(SAMPLES / "beam_dry" / "study.toml"))


@pytest.fixture(scope="module")
def sample(bench: OwnBench) -> Forecast:
    return forecast(bench)


def separating(sample: Forecast) -> Advice:
    """The advice that separates modulus, density and thickness from each other."""
    return next(one for one in sample.advice if one.change.key == "calibration")


@pytest.fixture(scope="module")
def cases(sample: Forecast) -> tuple[Case, ...]:
    return choose(sample.now, separating(sample), 12, np.random.default_rng(3))


@pytest.mark.long
def test_half_of_the_cases_are_what_the_advice_newly_tells_apart(
    sample: Forecast, cases: tuple[Case, ...]
) -> None:
    newly = {name for pair in separating(sample).separates for name in pair} - {"none"}
    first = cases[:6]
    assert {case.family.name for case in first} <= newly
    assert not {case.family.name for case in cases[6:]} & newly
    for case in first:
        assert case.now < SEEN <= case.then


def test_cases_stay_inside_the_range_of_their_effect(bench: OwnBench, cases: tuple[Case, ...]) -> None:
    for case in cases:
        assert case.family.low <= case.q <= case.family.high
        assert case.q != 0
        assert case.family.cause in bench.right(case)


def hidden(case: Case) -> list[tuple[str, dict[str, object]]]:
    return [(case.family.cause, dict(case.values))]


@pytest.mark.long
def test_the_data_of_a_case_say_nothing_of_what_is_hidden(
    bench: OwnBench, cases: tuple[Case, ...], tmp_path: Path
) -> None:
    made = bench.trial.write(hidden(cases[0]), tmp_path, seed=[1])
    assert made.tolerances == bench.study.tolerances
    assert made.model == bench.study.model
    assert made.test.calibration == bench.study.test.calibration
    words = effects_text(hidden(cases[0])).encode()
    simulate_test(bench.trial.ready, hidden(cases[0]), seed=1).write(tmp_path / "open.uff")
    assert words in (tmp_path / "open.uff").read_bytes()
    assert words not in (tmp_path / "test.uff").read_bytes()


def test_the_same_seed_writes_the_same_test(bench: OwnBench, cases: tuple[Case, ...], tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        bench.trial.write(hidden(cases[0]), tmp_path / name, seed=[4])
    assert (tmp_path / "a" / "test.uff").read_bytes() == (tmp_path / "b" / "test.uff").read_bytes()


def test_modes_alone_are_written_where_the_user_has_no_more(
    bench: OwnBench, cases: tuple[Case, ...], tmp_path: Path
) -> None:
    trial = replace(bench.trial, design=replace(bench.design, shapes=False))
    made = trial.write(hidden(cases[0]), tmp_path, seed=[1])
    assert made.test.modes == str(tmp_path / "test.csv")
    assert not made.test.files
    assert len((tmp_path / "test.csv").read_text().splitlines()) == 1 + bench.design.modes


def tried(case: Case, answer: Answer | None) -> Tried:
    return Tried(case, True, answer, frozenset({"section_scale", "calibration_gain"}))


def test_an_answer_is_right_if_it_names_the_effect_or_its_exact_equals_alone(
    cases: tuple[Case, ...],
) -> None:
    gain, scale, other = (frozenset({n}) for n in ("calibration_gain", "section_scale", "E"))
    both = tried(cases[0], Answer("class", (gain, scale)))
    assert both.named
    assert both.kept
    wide = tried(cases[0], Answer("class", (gain, other)))
    assert not wide.named
    assert wide.kept
    for answer in (Answer("none", ()), Answer("unknown", ()), Answer("named", (other,)), None):
        assert not tried(cases[0], answer).named
        assert not tried(cases[0], answer).kept


@pytest.mark.slow
def test_the_advice_followed_in_simulation_separates_what_the_test_could_not(sample: Forecast) -> None:
    """Modulus and thickness of the sample beam: a class as it is, each by its name once the chain is calibrated."""
    checked = check(sample, 8, 5, workers=2)
    newly = {name for pair in separating(sample).separates for name in pair}
    mine = [one for one in checked.tried if one.case.family.name in newly]
    before = [one for one in mine if not one.followed]
    after = [one for one in mine if one.followed]
    assert len(before) == len(after) >= 4
    assert all(one.named for one in after)
    assert sum(one.named for one in before) < len(before)
