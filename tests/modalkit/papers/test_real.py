"""Real structures, their cause withheld: the rules, what is written for the diagnosis, and what it answers."""

import json
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conforming import departures

from acquisition.errors import EstimationError, StudyError
from modalkit.blind.answer import Answer, Estimate, Row
from modalkit.cli.real import show_real
from modalkit.output.schemas import RealDocument
from modalkit.papers.real import (
    CASES,
    Case,
    Fact,
    Source,
    counts,
    judge,
    real_document,
    real_table,
    run_real,
)
from modalkit.papers.real.anonymous import data_files, without_tables, write_anonymous
from modalkit.papers.real.case import PUBLISHED, sets
from modalkit.papers.real.printed import PRINTED, PRINTED_LEFT_OUT, modes_table
from modalkit.study.read import read_study

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "benchmarks"))

from real_page import BEGIN, END, put_between_markers, real_markdown  # noqa: E402

SAMPLES = ROOT / "sample_data"
WATER = Fact("fluid_added_mass.fluid_density", 990.0, 1000.0, "water")


def case(**changes: Any) -> Case:
    plain: dict[str, Any] = {
        "name": "wet",
        "kind": PUBLISHED,
        "sources": (Source(Path("beam_wet/published.toml")),),
        "withheld": "the water",
        "known": "water",
        "source": "a paper",
        "accepted": sets("fluid_added_mass"),
    }
    return Case(**(plain | changes))


def answer(verdict: str, *named: str, **rest: Any) -> Answer:
    rows = tuple(Row(s, 1.0 / len(named), parameters=rest.get("parameters", {})) for s in sets(*named))
    stated = sets(*named) if verdict in ("named", "class") else ()
    return Answer(verdict, stated, rows, locations=rest.get("locations", ()))


def document(verdict: str, *named: str, value: float = 998.0) -> dict[str, Any]:
    parameter = {
        "value": value,
        "unit": "kg/m^3",
        "low95": 0.9 * value,
        "high95": 1.1 * value,
        "at_bound": False,
    }
    ranking = [
        {
            "effects": sorted(s),
            "probability": 1.0 / len(named),
            "equivalents": [],
            "plausible": True,
            "parameters": {"fluid_added_mass.fluid_density": parameter} if "fluid_added_mass" in s else {},
        }
        for s in sets(*named)
    ]
    held = {
        "before_percent": 20.0,
        "after_percent": 0.5,
        "runner_up_percent": 2.0,
        "noise_floor_percent": 0.1,
    }
    return {
        "significant": True,
        "p_value": 1e-9,
        "where": {"channel": "mass", "channels": {}, "location": None, "locations": []},
        "cause": {
            "verdict": verdict,
            "sets": [sorted(s) for s in sets(*named)] if named else [],
            "ranking": ranking,
        },
        "shrink": {"metric": "frequency", "before_percent": 20.0, "held_out": held, "closed_percent": None},
    }


@pytest.mark.parametrize(
    ("message", "grade"),
    [
        (answer("named", "fluid_added_mass"), "right"),
        (answer("named", "density"), "wrong"),
        (answer("named", "fluid_added_mass + E"), "partly"),
        (answer("class", "fluid_added_mass", "density"), "right"),
        (answer("class", "fluid_added_mass", "density", "clamp_rotation"), "partly"),
        (answer("class", "density", "clamp_rotation"), "wrong"),
        (answer("class", "fluid_added_mass", "density", "something_else"), "right"),
        (answer("class", "clamp_rotation", "something_else"), "wrong"),
        (answer("unknown", "density"), "partly"),
        (answer("none"), "wrong"),
    ],
)
def test_the_rules_with_the_effect_in_the_library(message: Answer, grade: str) -> None:
    assert judge(case(equivalent=sets("density")), message).grade == grade


@pytest.mark.parametrize(
    ("message", "grade"),
    [
        (answer("unknown", "clamp_rotation"), "right"),
        (answer("named", "density"), "right"),
        (answer("class", "density", "clamp_rotation"), "partly"),
        (answer("named", "density + clamp_rotation"), "partly"),
        (answer("named", "clamp_rotation"), "wrong"),
        (answer("none"), "wrong"),
    ],
)
def test_the_rules_with_the_effect_left_out(message: Answer, grade: str) -> None:
    left_out = case(stands_in=sets("density")).left_out()
    assert left_out.removed == ("fluid_added_mass",)
    assert judge(left_out, message).grade == grade


def test_a_factor_beside_the_cause_is_no_part_of_the_truth() -> None:
    with_factor = case(accepted=sets("fluid_added_mass", "fluid_added_mass + E"))
    assert judge(with_factor, answer("named", "E")).grade == "wrong"
    assert judge(with_factor, answer("named", "fluid_added_mass + taper")).grade == "partly"
    two = case(accepted=sets("clamp_rotation", "local_stiffness", "clamp_rotation + E"))
    assert judge(two, answer("named", "E")).grade == "wrong"
    assert judge(two, answer("named", "local_stiffness + taper")).grade == "partly"


@pytest.mark.parametrize(
    ("message", "grade"),
    [(answer("none"), "right"), (answer("unknown", "E"), "wrong"), (answer("named", "E"), "wrong")],
)
def test_where_nothing_is_missing_any_name_is_a_false_alarm(message: Answer, grade: str) -> None:
    assert judge(case(accepted=(frozenset(),)), message).grade == grade


@pytest.mark.parametrize(("low", "high", "grade"), [(900.0, 1100.0, "right"), (1001.0, 1300.0, "partly")])
def test_a_known_number_has_to_lie_in_the_interval(low: float, high: float, grade: str) -> None:
    stated = {"fluid_added_mass.fluid_density": Estimate((low + high) / 2, low, high)}
    assert judge(case(facts=(WATER,)), answer("named", "fluid_added_mass", parameters=stated)).grade == grade


@pytest.mark.parametrize(("x", "grade"), [(0.65, "right"), (0.1, "partly")])
def test_a_known_place_has_to_be_pointed_to(x: float, grade: str) -> None:
    taped = case(accepted=sets("damping_patch"), places=((0.5, 0.8),))
    assert judge(taped, answer("named", "damping_patch", locations=((x, 0.0),))).grade == grade


@pytest.mark.parametrize("one", CASES, ids=lambda c: c.name)
def test_every_case_is_told_with_its_source_and_has_a_study(one: Case) -> None:
    assert one.withheld
    assert one.known
    assert one.source
    assert one.why or not (one.equivalent or one.stands_in)
    if not one.in_data:
        assert all((SAMPLES / source.path).exists() for source in one.sources if source.path)


def test_the_cases_have_names_of_their_own() -> None:
    assert len({one.name for one in CASES}) == len(CASES)


def test_the_copy_says_nothing_of_what_is_withheld(tmp_path: Path) -> None:
    study = write_anonymous(Source(Path("plate_wet/published.toml")), SAMPLES, tmp_path, 0)
    everything = " ".join(p.name + p.read_text(encoding="utf-8") for p in tmp_path.iterdir()).lower()
    for word in ("wet", "water", "submerged", "dry", "paper", "cantilever"):
        assert word not in everything, word
    copied = tomllib.loads(study.read_text(encoding="utf-8"))
    original = tomllib.loads((SAMPLES / "plate_wet" / "published.toml").read_text(encoding="utf-8"))
    assert copied["model"] == original["model"]
    assert copied["tolerances"] == original["tolerances"]
    assert all((tmp_path / name).exists() for name in data_files(copied))
    assert len(data_files(copied)) == 2


def test_a_study_can_be_written_without_its_baseline(tmp_path: Path) -> None:
    source = Source(Path("beam_wet/published.toml"), drop=("baseline",))
    copied = tomllib.loads(write_anonymous(source, SAMPLES, tmp_path, 0).read_text(encoding="utf-8"))
    assert "baseline" not in copied
    assert copied["test"]["modes"] == "test0-0.csv"


def test_dropping_a_table_takes_its_subtables_with_it() -> None:
    text = "[a]\nx = 1\n[b]\ny = 2\n# said\n[b.c]\nz = 3\n[[d]]\nw = 4\n"
    assert tomllib.loads(without_tables(text, ("b",))) == {"a": {"x": 1}, "d": [{"w": 4}]}


def test_a_study_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"nowhere\.toml"):
        write_anonymous(Source(Path("nowhere.toml")), SAMPLES, tmp_path, 0)


def test_the_diagnosis_is_given_study_shared_and_left_out_and_nothing_else() -> None:
    seen: list[tuple[list[str], tuple[str, ...], tuple[str, ...]]] = []

    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        seen.append((sorted(p.name for p in studies[0].parent.iterdir()), shared, without))
        return document("unknown", "density")

    both = case(accepted=sets("length + sensor_mass"), shared=("length", "E"))
    run_real([both, both.left_out()], SAMPLES, None, diagnose=diagnose)
    files = ["study0.toml", "test0-0.csv", "test0-1.csv"]
    assert seen == [(files, ("length", "E"), ()), (files, ("E",), ("length", "sensor_mass"))]


def test_outcomes_come_in_the_order_of_the_cases_with_any_number_of_workers() -> None:
    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        return document("named", *(shared or ("fluid_added_mass",)))

    cases = [case(name=str(i), shared=("E",) if i % 2 else ()) for i in range(6)]
    tables = [real_table(run_real(cases, SAMPLES, None, workers=n, diagnose=diagnose)) for n in (1, 3)]
    assert tables[0].equals(tables[1])
    assert list(tables[0]["said"]) == ["named: fluid_added_mass", "named: E"] * 3


def test_what_is_missing_or_fails_is_said_and_the_rest_goes_on(tmp_path: Path) -> None:
    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        if without:
            raise EstimationError("the diagnosis ended with code 2: no modes")
        return document("named", "fluid_added_mass")

    cases = [case(in_data=True), case().left_out(), case()]
    outcomes = run_real(cases, SAMPLES, None, diagnose=diagnose)
    assert [o.missing for o in outcomes] == [
        "needs the folder of measured data; name it with --data",
        "failed: the diagnosis ended with code 2: no modes",
        None,
    ]
    assert run_real(cases[:1], SAMPLES, tmp_path, diagnose=diagnose)[0].missing is not None
    assert counts(outcomes) == {"right": 1, "partly": 0, "wrong": 0}
    with pytest.raises(StudyError, match="0 workers"):
        run_real(cases, SAMPLES, None, workers=0, diagnose=diagnose)


def test_the_record_and_the_tables_of_the_docs_tell_the_same() -> None:
    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        return (
            document("unknown", "density") if without else document("named", "fluid_added_mass", value=1200.0)
        )

    outcomes = run_real([case(facts=(WATER,)), case().left_out()], SAMPLES, None, diagnose=diagnose)
    record = json.loads(json.dumps(real_document(outcomes), allow_nan=False))
    assert not departures(record, RealDocument)
    assert record["counts"] == {"right": 1, "partly": 1, "wrong": 0}
    first = record["cases"][0]
    assert first["grade"] == "partly"
    assert first["facts"][0]["covered"] is False
    assert "cause" in first["diagnosis"]
    assert "name" not in first["diagnosis"]
    page = put_between_markers(f"head\n{BEGIN}\nold\n{END}\ntail", real_markdown(record))
    assert "old" not in page
    assert page.startswith("head")
    assert page.endswith("tail")
    assert "fluid density 1200 kg/m^3 (1080 to 1320)" in page
    assert "20 -> 0.5" in page
    assert "right: unknown" in page
    with pytest.raises(ValueError, match="no <!-- real"):
        put_between_markers("no markers", "")


@pytest.mark.parametrize(
    ("name", "unit", "value", "stated"),
    [
        ("length.extension", "m", 0.02668, "extension 26.7 mm (24 to 29.3)"),
        ("local_stiffness.x", "m", 1.11, "x 1.11 m (0.999 to 1.22)"),
        ("sensor_mass.mass", "kg", 0.01, "mass 10 g (9 to 11)"),
        ("E.factor", "-", 0.76, "factor 0.76 (0.684 to 0.836)"),
    ],
)
def test_sizes_are_told_in_handy_units(name: str, unit: str, value: float, stated: str) -> None:
    effect = name.partition(".")[0]

    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        message = document("named", effect)
        size = {"value": value, "unit": unit, "low95": 0.9 * value, "high95": 1.1 * value, "at_bound": False}
        message["cause"]["ranking"][0]["parameters"] = {name: size}
        message["where"]["locations"] = [[0.5, 0.0, 0.0]]
        return message

    cases = [case(accepted=sets(effect)), case(accepted=sets(effect), places=((0.4, 0.6),))]
    rows = real_table(run_real(cases, SAMPLES, None, diagnose=diagnose))
    assert list(rows["size (95 %)"]) == [stated, f"{stated}; at x = 500 mm"]


def test_the_docs_list_every_case() -> None:
    page = (ROOT / "docs" / "trust" / "real.md").read_text(encoding="utf-8")
    table = page.partition(BEGIN)[2].partition(END)[0]
    assert not [one.name for one in CASES if f"| {one.name} |" not in table]


@pytest.mark.long
def test_published_water_is_named_and_its_density_found() -> None:
    wet = next(one for one in CASES if one.name == "beam in water")
    (outcome,) = run_real([wet], SAMPLES, None)
    assert outcome.missing is None
    assert outcome.judgement is not None
    assert outcome.judgement.grade == "right", outcome.judgement.reason


@pytest.mark.slow
def test_the_command_judges_every_published_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "real.json"
    show_real(None, out, 2)
    record = json.loads(out.read_text(encoding="utf-8"))
    assert [c["name"] for c in record["cases"]] == [one.name for one in CASES]
    skipped = [c["name"] for c in record["cases"] if c["missing"]]
    assert skipped == [one.name for one in CASES if one.in_data]
    printed = capsys.readouterr().out
    assert "How answers are graded" in printed
    assert "plate in water" in printed


def test_the_matrices_of_a_model_go_with_it(tmp_path: Path) -> None:
    """Bodies that a model lists under the same key as a file of masses are none."""
    for name in ("K.mtx", "m1.mtx", "nodes.csv", "after.csv", "before.csv"):
        (tmp_path / name).write_text("1 1\n", encoding="utf-8")
    text = (
        'title = "Frame, storey 2 softer"\n[test]\nmodes = "after.csv"\n[baseline]\nmodes = "before.csv"\n[model]\n'
        'type = "matrices"\nstiffness = "K.mtx"\nnodes = "nodes.csv"\nmass_parts = ["m1.mtx"]\n'
        "[[model.mass]]\nat = [0.1]\nmass = 0.2\n"
    )
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    folder = tmp_path / "copy"
    folder.mkdir()
    study = write_anonymous(Source(Path("study.toml")), tmp_path, folder, 0)
    written = tomllib.loads(study.read_text(encoding="utf-8"))
    assert written["title"] == "Test 0"
    assert sorted(data_files(written)) == sorted(p.name for p in folder.iterdir() if p.suffix != ".toml")
    assert len(data_files(written)) == 5
    assert not {"K.mtx", "after.csv"} & set(data_files(written))


@pytest.mark.parametrize("one", PRINTED, ids=lambda c: c.name)
def test_a_printed_structure_needs_no_folder(one: Case, tmp_path: Path) -> None:
    (source,) = one.sources
    assert source.path is None
    assert not one.in_data
    path = write_anonymous(source, None, tmp_path, 0)
    written = tomllib.loads(path.read_text(encoding="utf-8"))
    assert set(data_files(written)) == {p.name for p in tmp_path.iterdir() if p.suffix != ".toml"}
    tables = [
        np.loadtxt(tmp_path / written[part]["modes"], delimiter=",", skiprows=1)
        for part in ("test", "baseline")
        if part in written
    ]
    for modes in tables:
        assert modes.shape == tables[0].shape
        assert (np.diff(modes[:, 0]) > 0.0).all()
        assert (modes[:, 1] < 0.05 * modes[:, 0]).all()
    assert read_study(path).model is not None


def test_printed_structures_stand_among_the_cases() -> None:
    names = [one.name for one in CASES]
    assert {one.name for one in (*PRINTED, *PRINTED_LEFT_OUT)} <= set(names)
    assert len(PRINTED) >= 10
    assert all(one.removed for one in PRINTED_LEFT_OUT)


def test_a_printed_digit_and_the_fit_make_the_standard_deviation() -> None:
    assert modes_table((641.0,), 1.0, 0.0) == f"frequency,sigma\n641,{1 / 12**0.5:.4g}\n"
    assert modes_table((641.0,), 0.0, 0.01) == "frequency,sigma\n641,6.41\n"


def test_changed_structures_have_names_of_their_own() -> None:
    names = [one.name for one in CASES]
    assert len(set(names)) == len(names)
    assert all(one.source and one.known for one in CASES)
