"""The JSON records: the keys of the contract, nothing that is not JSON, files whole or not at all."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conforming import departures
from hypothesis import given
from hypothesis import strategies as st

from acquisition import HitVerdict
from acquisition.dof import Dof
from acquisition.errors import InputError
from modalkit.output import whole
from modalkit.output.documents import diagnosis_document, modes_document
from modalkit.output.library import effects_document
from modalkit.output.schemas.diagnosis import DiagnosisDocument
from modalkit.output.schemas.effects import EffectsDocument
from modalkit.output.schemas.modes import ModesDocument
from modalkit.output.whole import plain, write_json, write_text
from modalkit.study.read import read_study
from modalkit.workflow.case import process
from updating import Axes, Case, Diagnosis, Material, Measured, Spec, diagnose, measured_from_modes
from updating.diagnosis.answer.closing import Closed
from updating.diagnosis.answer.result import NextTest

SAMPLE = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry" / "study.toml"
MODES = {"schema", "modes", "points_rejected", "hits", "window_decay_removed", "warnings"}
MODE = {
    *("frequency_hz", "frequency_sigma_hz", "damping_ratio", "damping_sigma"),
    *("shape", "mpc", "scaled"),
}
COMPONENT = {"node", "direction", "re", "im", "sigma"}
HIT = {"point", "hit", "used", "reasons"}
DIAGNOSIS = {"schema", "significant", "p_value", "gap", "where", "cause", "shrink", "next_test", "warnings"}
PARTS = {
    "gap": {"frequency_rms_percent", "noise_floor_percent", "modes", "frac"},
    "where": {"channel", "channels", "location", "locations", "points", "zones"},
    "cause": {"verdict", "lacks", "effects", "sets", "ranking"},
    "shrink": {"metric", "before_percent", "after_percent", "held_out", "closed_percent"},
}
ENTRIES = {
    ("gap", "modes"): {
        *("study", "test_hz", "model_hz", "error_percent", "sigma_percent"),
        *("mac", "test_damping", "model_damping"),
    },
    ("where", "zones"): {"name", "center", "probability"},
    ("cause", "ranking"): {"effects", "probability", "equivalents", "parameters", "plausible"},
}
PARAMETER = {"value", "unit", "low95", "high95", "at_bound"}
HELD_OUT = {
    *("before_percent", "after_percent", "runner_up_percent"),
    *("nuisance_only_percent", "noise_floor_percent"),
}


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    """Frequencies alone, without damping or shapes: as much as possible is unknown."""
    from acquisition import ModalData

    steel = Material(210e9, 7850.0)
    spec = Spec(
        "beam",
        length=0.376,
        width=0.0305,
        thickness=0.0047625,
        elements=(8,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=steel,
    )
    frequency = 0.9 * np.array([28.146, 176.39, 494.01])
    measured = measured_from_modes(
        ModalData(frequency=frequency, frequency_sigma=1e-4 * frequency), Axes(), spec
    )
    assert isinstance(measured, Measured)
    from updating import LIBRARY

    return diagnose(Case("beam", spec, measured), library=[LIBRARY["E"], LIBRARY["sensor_mass"]])


def written(record: Mapping[str, object]) -> dict[str, Any]:
    """The record as it comes back from strict JSON."""

    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is not JSON")

    found: dict[str, Any] = json.loads(json.dumps(plain(record), allow_nan=False), parse_constant=refuse)
    return found


def test_the_record_of_an_identification(tmp_path: Path) -> None:
    study = read_study(SAMPLE)
    processed, model = process(study)
    record = written(modes_document(model, processed.hits, processed.warnings))
    assert not departures(record, ModesDocument)
    assert set(record) >= MODES
    assert record["schema"] == "modalkit.modes/1"
    assert record["window_decay_removed"] == pytest.approx(8.0)
    assert len(record["modes"]) == 3
    for mode in record["modes"]:
        assert set(mode) >= MODE
        assert isinstance(mode["scaled"], bool)
        assert mode["shape"]
        assert all(set(c) >= COMPONENT for c in mode["shape"])
        assert all(isinstance(c["node"], int) for c in mode["shape"])
    assert [m["frequency_hz"] for m in record["modes"]] == pytest.approx([24.47, 153.96, 429.15], rel=1e-3)
    assert record["hits"]
    assert all(set(h) >= HIT for h in record["hits"])
    assert {type(h["used"]) for h in record["hits"]} == {bool}


def test_the_record_of_a_hit() -> None:
    from modalkit.output.documents import hit_document

    verdict = HitVerdict(
        point=Dof(3, -3),
        hit=2,
        used=False,
        reasons=("double hit",),
        peak=1.0,
        width=1.0,
        band10=1.0,
        band20=1.0,
    )
    assert written(hit_document(verdict)) == {
        "point": "3-Z",
        "hit": 2,
        "used": False,
        "reasons": ["double hit"],
    }


def check(record: dict[str, Any]) -> None:
    assert not departures(record, DiagnosisDocument)
    assert set(record) >= DIAGNOSIS
    assert record["schema"] == "modalkit.diagnosis/1"
    assert isinstance(record["significant"], bool)
    for name, keys in PARTS.items():
        assert set(record[name]) >= keys, name
    for (part, name), keys in ENTRIES.items():
        assert record[part][name], name
        assert all(set(entry) >= keys for entry in record[part][name]), name
    assert set(record["shrink"]["held_out"]) >= HELD_OUT
    assert record["cause"]["verdict"] in {"named", "class", "unknown", "none"}
    assert record["shrink"]["metric"] in {"frequency", "damping", "frf", "combined"}
    assert record["where"]["channel"] in {"stiffness", "mass", "damping", "measurement", "none"}
    assert set(record["where"]["channels"]) >= {"stiffness", "mass", "damping", "measurement"}
    for row in record["cause"]["ranking"]:
        for name, parameter in row["parameters"].items():
            assert name.split(".")[0] in row["effects"]
            assert set(parameter) >= PARAMETER


def test_the_record_of_a_diagnosis(diagnosis: Diagnosis) -> None:
    record = written(diagnosis_document(diagnosis, ["take care"]))
    check(record)
    assert record["cause"]["effects"] == ["E"]
    assert record["cause"]["sets"] == [["E"]]
    assert record["cause"]["lacks"] is None
    rejected = replace(diagnosis, verdict="unknown", sets=(), lacks="closing")
    assert written(diagnosis_document(rejected))["cause"]["lacks"] == "closing"
    mode = record["gap"]["modes"][0]
    assert (mode["mac"], mode["test_damping"]) == (None, None)
    assert mode["error_percent"] == pytest.approx(100 * (1 / 0.9 - 1), rel=1e-3)
    assert record["warnings"][-1] == "take care"


def test_what_may_be_missing_is_null_or_complete(diagnosis: Diagnosis) -> None:
    shrink = replace(diagnosis.shrink, closed=Closed(90.0, 80.0, 95.0), held_runner_up=None)
    tests = (NextTest("weigh it", ("E", "density"), 12.0),)
    record = written(diagnosis_document(replace(diagnosis, shrink=shrink, next_test=tests)))
    check(record)
    assert record["shrink"]["closed_percent"] == {"value": 90.0, "low95": 80.0, "high95": 95.0}
    assert record["shrink"]["held_out"]["runner_up_percent"] is None
    assert record["next_test"] == [
        {"measure": "weigh it", "separates": ["E", "density"], "expected_sigma": 12.0}
    ]
    none = replace(diagnosis, shrink=replace(shrink, closed=None))
    assert written(diagnosis_document(none))["shrink"]["closed_percent"] is None


def test_the_library_can_be_written() -> None:
    assert not departures(written(effects_document()), EffectsDocument)


numbers = st.one_of(
    st.integers(-(2**40), 2**40),
    st.floats(),
    st.booleans(),
    st.none(),
    st.text(max_size=5),
    st.floats().map(np.float64),
    st.integers(-9, 9).map(np.int64),
    st.booleans().map(np.bool_),
    st.lists(st.floats(), max_size=3).map(np.array),
)
records = st.recursive(
    numbers,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.lists(inner, max_size=3).map(tuple),
        st.dictionaries(st.text(max_size=3), inner, max_size=3),
    ),
    max_leaves=8,
)


@given(record=records)
def test_anything_numpy_holds_becomes_strict_json(record: Any) -> None:
    once = plain(record)
    assert json.loads(json.dumps(once, allow_nan=False)) == once


def test_what_is_not_finite_is_null() -> None:
    found = plain({"a": np.nan, "b": [np.inf, 1.5], "c": np.array([1.0, -np.inf]), 3: np.float32("nan")})
    assert found == {"a": None, "b": [None, 1.5], "c": [1.0, None], "3": None}


def test_a_file_is_written_whole(tmp_path: Path) -> None:
    path = tmp_path / "out.json"
    write_json(path, {"schema": "modalkit.modes/1", "a": (1, np.nan)})
    assert json.loads(path.read_text(encoding="utf-8")) == {"schema": "modalkit.modes/1", "a": [1, None]}
    write_text(path, "größer")
    assert path.read_text(encoding="utf-8") == "größer"
    assert [p.name for p in tmp_path.iterdir()] == ["out.json"]


@pytest.mark.parametrize("fault", ["write", "replace"])
def test_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str) -> None:
    """A disk that fills up leaves what stood there before, and nothing else."""
    path = tmp_path / "out.json"
    path.write_text("before", encoding="utf-8")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    if fault == "replace":
        monkeypatch.setattr(Path, "replace", full)
    else:
        monkeypatch.setattr(whole.Path, "chmod", full)
    with pytest.raises(InputError, match=r"out\.json: cannot be written \(No space left"):
        write_text(path, "after")
    assert path.read_text(encoding="utf-8") == "before"
    assert [p.name for p in tmp_path.iterdir()] == ["out.json"]


def test_a_fault_of_ours_leaves_no_litter_either(tmp_path: Path) -> None:
    path = tmp_path / "out.json"
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "\ud800")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="name a folder that exists"):
        write_text(tmp_path / "no" / "out.json", "x")
    with pytest.raises(InputError, match="cannot be written"):
        write_text(tmp_path, "x")
