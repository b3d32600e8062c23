"""Runs of the rig with diagnoses that are known."""

from __future__ import annotations

import json
import os
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from acquisition.errors import EstimationError, StudyError
from modalkit.blind.run import Outcome, diagnose_in_subprocess, run_blind
from modalkit.blind.scoring.score import score
from modalkit.blind.seal import open_seal

NONE = {
    "where": {"location": None},
    "cause": {"verdict": "none", "effects": [], "sets": [], "ranking": []},
    "shrink": {"closed_percent": None},
}
FAST = ["none", "E", "clamp_rotation"]


def always_none(study: Path) -> Mapping[str, Any]:
    return NONE


def broken(study: Path) -> Mapping[str, Any]:
    raise EstimationError("no modes in the band")


def stiffness(study: Path) -> Mapping[str, Any]:
    row = {"effects": ["E"], "probability": 1.0, "equivalents": [], "parameters": {}, "plausible": True}
    return NONE | {"cause": {"verdict": "named", "effects": ["E"], "sets": [["E"]], "ranking": [row]}}


def test_constant_answer_earns_what_it_deserves() -> None:
    result = run_blind(6, 3, diagnose=always_none, effects=FAST)
    truths = [o.truth.effect for o in result.outcomes]
    table = score(result).trials
    assert table["right"].tolist() == [name == "none" for name in truths]
    named = score(run_blind(6, 3, diagnose=stiffness, effects=FAST)).trials
    assert named["right"].tolist() == [name == "E" for name in truths]
    assert len(set(truths)) > 1


def test_result_does_not_depend_on_workers() -> None:
    one, two = (run_blind(4, 5, diagnose=always_none, effects=FAST, workers=w) for w in (1, 2))
    assert [o.truth for o in one.outcomes] == [o.truth for o in two.outcomes]
    assert [o.index for o in two.outcomes] == [0, 1, 2, 3]
    columns = [c for c in score(one).trials.columns if c != "seconds"]
    assert score(one).trials[columns].equals(score(two).trials[columns])


def test_failed_diagnosis_is_counted_with_its_message() -> None:
    ended: list[Outcome] = []
    result = run_blind(2, 3, diagnose=broken, effects=["E"], progress=ended.append)
    assert [o.failure for o in ended] == ["EstimationError: no modes in the band"] * 2
    rates = score(result).rates
    assert rates.loc["diagnosis failed", "rate"] == 1.0
    assert rates.loc["most probable answer is the truth", "count"] == 0


def test_commitments_are_announced_before_the_diagnosis_and_open_afterwards() -> None:
    events: list[str] = []
    published: dict[int, str] = {}

    def announce(index: int, commitment: str) -> None:
        published[index] = commitment
        events.append("sealed")

    def watched(study: Path) -> Mapping[str, Any]:
        events.append("diagnosed")
        return NONE

    result = run_blind(2, 3, diagnose=watched, effects=FAST, announce=announce)
    assert events == ["sealed", "diagnosed"] * 2
    for outcome in result.outcomes:
        content = open_seal(outcome.sealed, published[outcome.index])
        assert content["effect"] == outcome.truth.effect


def test_the_folder_tells_nothing_and_is_gone_afterwards() -> None:
    seen: dict[Path, list[str]] = {}
    texts: list[bytes] = []

    def curious(study: Path) -> Mapping[str, Any]:
        seen[study.parent] = sorted(p.name for p in study.parent.iterdir())
        texts.extend(p.read_bytes() for p in study.parent.iterdir())
        tomllib.loads(study.read_text())
        return NONE

    run_blind(3, 424242, diagnose=curious, effects=["fluid_added_mass", "sensor_mass"])
    for folder, names in seen.items():
        assert set(names) <= {"study.toml", "test.uff", "baseline.uff"}
        assert not folder.exists()
        assert "424242" not in str(folder)
    for text in texts:
        assert b"424242" not in text
        assert b"fluid" not in text.replace(b"fluid_density = 998.0", b"")
        assert b"sensor" not in text


def test_records_are_the_same_again() -> None:
    first: list[bytes] = []

    def keep(study: Path) -> Mapping[str, Any]:
        first.append((study.parent / "test.uff").read_bytes()[-4000:])
        return NONE

    run_blind(1, 8, diagnose=keep, effects=FAST)
    run_blind(1, 8, diagnose=keep, effects=FAST)
    assert first[0] == first[1]


@pytest.mark.parametrize(("trials", "workers"), [(0, 1), (1, 0)])
def test_nothing_to_do_is_refused(trials: int, workers: int) -> None:
    with pytest.raises(StudyError, match="at least 1"):
        run_blind(trials, 1, diagnose=always_none, workers=workers)


@pytest.fixture
def stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put a small program in the interpreter's place; it gets the command's arguments."""
    program = tmp_path / "python"
    monkeypatch.setattr(sys, "executable", str(program))
    return program


def install(program: Path, body: str) -> None:
    program.write_text(f"#!/bin/sh\n{body}\n")
    program.chmod(0o755)


def test_process_gets_the_study_and_nothing_else(stand_in: Path, tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    study.write_text("")
    install(stand_in, f'cat > diagnosis.json <<END\n{json.dumps(NONE)}\nEND\necho "$@" > arguments')
    assert diagnose_in_subprocess(study) == NONE
    assert (tmp_path / "arguments").read_text().split() == [
        *("-m", "modalkit", "diagnose", "study.toml", "--json", "diagnosis.json")
    ]


def test_failing_process_is_reported(stand_in: Path, tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    study.write_text("")
    install(stand_in, "echo first >&2; echo 'study.toml: no modes' >&2; exit 2")
    with pytest.raises(EstimationError, match=r"code 2: study\.toml: no modes"):
        diagnose_in_subprocess(study)
    install(stand_in, "exit 0")
    with pytest.raises(EstimationError, match="no readable JSON"):
        diagnose_in_subprocess(study)
    install(stand_in, "exec sleep 5")
    with pytest.raises(EstimationError, match=r"within 0\.2 s"):
        diagnose_in_subprocess(study, timeout=0.2)


def test_process_sees_one_thread_unless_told(stand_in: Path, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    study = tmp_path / "study.toml"
    study.write_text("")
    install(
        stand_in,
        f'cat > diagnosis.json <<END\n{json.dumps(NONE)}\nEND\necho "$OPENBLAS_NUM_THREADS" > threads',
    )
    diagnose_in_subprocess(study)
    assert (tmp_path / "threads").read_text().strip() == "1"
    assert "OPENBLAS_NUM_THREADS" not in os.environ
