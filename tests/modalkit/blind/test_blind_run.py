"""Runs of the rig with diagnoses that are known."""

from __future__ import annotations

import json
import secrets
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import blind_stub
import pytest
from blind_stub import NONE

from acquisition.errors import EstimationError, StudyError
from modalkit.blind import BlindResult, DrawRanges, Outcome, diagnosers, open_seal, run_blind, score

pytestmark = pytest.mark.long

FAST = DrawRanges(kinds=("beam",), effects=("none", "E", "clamp_rotation"), pairs=0.0, outside=0.0)


def always_none(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
    return NONE


def broken(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
    raise EstimationError("no modes in the band")


def stated(result: BlindResult) -> str:
    """Return all that a run says and does not depend on the clock or on chance: the scores, without salts."""
    records = [o.to_json() | {"seconds": 0, "salt": ""} for o in result.outcomes]
    table = score(result).to_json()
    table.pop("seals", None)
    text = json.dumps([records, table], sort_keys=True)
    for outcome in result.outcomes:
        text = text.replace(outcome.sealed.commitment, "").replace(outcome.sealed.salt, "")
    return text


def test_result_does_not_depend_on_workers() -> None:
    one, two = (run_blind(4, 5, plan=FAST, diagnose=always_none, workers=w) for w in (1, 2))
    assert [o.index for o in two.outcomes] == [0, 1, 2, 3]
    assert stated(one) == stated(two)
    other = run_blind(4, 6, plan=FAST, diagnose=always_none)
    assert stated(other) != stated(one)


def test_a_constant_answer_is_right_where_nothing_is_hidden() -> None:
    result = run_blind(6, 3, plan=FAST, diagnose=always_none)
    hidden = [o.truth.effects for o in result.outcomes]
    assert score(result).trials["right"].tolist() == [effects == () for effects in hidden]
    assert len(set(hidden)) > 1


def test_failed_diagnosis_is_kept_with_its_message() -> None:
    ended: list[Outcome] = []
    result = run_blind(2, 3, plan=FAST, diagnose=broken, progress=ended.append)
    assert [o.failure for o in ended] == ["EstimationError: no modes in the band"] * 2
    assert all(o.answer is None and o.document is None for o in result.outcomes)


def test_commitments_are_announced_before_the_diagnosis_and_open_afterwards() -> None:
    events: list[str] = []
    published: dict[int, str] = {}

    def announce(index: int, commitment: str) -> None:
        published[index] = commitment
        events.append("sealed")

    def watched(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
        events.append("diagnosed")
        return NONE

    result = run_blind(2, 3, plan=FAST, diagnose=watched, announce=announce)
    assert events == ["sealed", "diagnosed"] * 2
    for outcome in result.outcomes:
        content = open_seal(outcome.sealed, published[outcome.index])
        assert tuple(content["effects"]) == outcome.truth.effects


def test_what_is_left_out_is_handed_over() -> None:
    asked: list[tuple[str, ...]] = []

    def keep(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
        asked.append(without)
        return NONE

    plan = DrawRanges(kinds=("beam",), effects=("E",), pairs=0.0, outside=0.0, leave_out=True)
    result = run_blind(1, 3, plan=plan, diagnose=keep)
    assert asked == [result.outcomes[0].truth.without]
    assert "E" in asked[0]


def test_outcomes_come_back_from_json_as_they_were() -> None:
    for outcome in run_blind(2, 7, plan=FAST, diagnose=always_none).outcomes:
        again = Outcome.from_json(json.loads(json.dumps(outcome.to_json())))
        assert again.truth == outcome.truth
        assert again.to_json() == outcome.to_json()
        assert again.answer is not None
        assert "modes" not in (again.document or {})["gap"]


def test_the_folder_tells_nothing_and_is_gone_afterwards() -> None:
    seen: dict[Path, list[str]] = {}
    texts: list[bytes] = []

    def curious(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
        seen[study.parent] = sorted(p.name for p in study.parent.iterdir())
        texts.extend(p.read_bytes() for p in study.parent.iterdir())
        return NONE

    plan = DrawRanges(kinds=("beam",), effects=("clamp_rotation", "sensor_mass"), pairs=0.0, outside=0.0)
    run_blind(3, 424242, plan=plan, diagnose=curious)
    for folder, names in seen.items():
        assert set(names) <= {"study.toml", "test.uff", "baseline.uff"}
        assert not folder.exists()
        assert "424242" not in str(folder)
    for text in texts:
        assert b"424242" not in text
        assert b"clamp_rotation" not in text
        assert b"sensor" not in text


def test_a_diagnosis_that_looks_for_the_truth_does_not_find_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It looks through folders, temporary files, environment, arguments, and its parent's open files."""
    work = tmp_path / "temporary"
    work.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(work))
    monkeypatch.setenv("A_SECRET_OF_THE_SHELL", "4711-0815")
    seed, found = secrets.randbits(63), tmp_path / "found"
    with diagnosers(1, command=blind_stub.command("curious", found)) as diagnose:
        result = run_blind(3, seed, plan=FAST, diagnose=diagnose, store=tmp_path / "run.jsonl")
    evaluations = [json.loads(line) for line in found.read_text().splitlines()]
    assert len(evaluations) == 3
    for number, (evaluation, outcome) in enumerate(zip(evaluations, result.outcomes, strict=True)):
        assert "study.toml" in evaluation
        assert str(seed) not in evaluation
        assert "4711-0815" not in evaluation
        assert outcome.sealed.salt not in evaluation
        assert outcome.sealed.statement not in evaluation
        if Path(
            "/proc/self/fd"
        ).is_dir():  # what was opened before may be seen, so it does look into the store
            assert all(o.sealed.salt in evaluation for o in result.outcomes[:number])
            assert {int(w[3:]) for w in evaluation.split("\n") if w.startswith("fd ")} <= {0, 1, 2, 3, 4}


def test_a_killed_diagnosing_process_loses_nothing(tmp_path: Path) -> None:
    def run(*words: object) -> BlindResult:
        with diagnosers(2, command=blind_stub.command(*words)) as diagnose:
            return run_blind(4, 5, plan=FAST, diagnose=diagnose, workers=2)

    undisturbed, killed = run(), run("dies-once", tmp_path / "died")
    assert (tmp_path / "died").exists()
    assert all(o.failure is None for o in killed.outcomes)
    assert stated(undisturbed) == stated(killed)


@pytest.mark.parametrize(("trials", "workers"), [(0, 1), (1, 0)])
def test_nothing_to_do_is_refused(trials: int, workers: int) -> None:
    with pytest.raises(StudyError, match="at least 1"):
        run_blind(trials, 1, diagnose=always_none, workers=workers)


def test_the_score_does_not_need_the_documents() -> None:
    whole, lean = (run_blind(2, 5, plan=FAST, diagnose=always_none, documents=d) for d in (True, False))
    assert whole.outcomes[0].document is not None
    assert lean.outcomes[0].document is None
    assert score(whole).rates.frame().equals(score(lean).rates.frame())


def test_an_error_of_the_one_who_listens_ends_the_run() -> None:
    def full(outcome: Outcome) -> None:
        raise OSError("no space left")

    with pytest.raises(OSError, match="no space"):
        run_blind(3, 5, plan=FAST, diagnose=always_none, progress=full)
