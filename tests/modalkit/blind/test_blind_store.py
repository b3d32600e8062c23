"""The store of a run: what is in it survives, what was changed is found, what is another run's is refused."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import blind_stub
import pytest
from blind_stub import NONE

from acquisition.errors import InputError
from modalkit import cli
from modalkit.blind import DrawRanges, check_store, run_blind
from modalkit.blind import store as store_module
from modalkit.cli import blinding
from modalkit.samples import sample_file
from modalkit.workers.journal import Journal, read_journal

pytestmark = pytest.mark.long

FAST = DrawRanges(kinds=("beam",), effects=("none", "E", "clamp_rotation"), pairs=0.0, outside=0.0)
SEED = 5


def always_none(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
    return NONE


def records(path: Path) -> list[str]:
    """Return what a run says of each trial, without salts and seconds."""
    outcomes = check_store(path).outcomes
    return [json.dumps(outcomes[i].to_json() | {"salt": "", "seconds": 0}) for i in sorted(outcomes)]


@pytest.fixture(scope="module")
def three(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("store") / "run.jsonl"
    run_blind(3, SEED, plan=FAST, diagnose=always_none, store=path)
    return path


@pytest.fixture
def store(three: Path, tmp_path: Path) -> Path:
    copy = tmp_path / "run.jsonl"
    copy.write_bytes(three.read_bytes())
    return copy


def test_full_disk_leaves_no_part_of_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, write = tmp_path / "run.jsonl", os.write

    def full(file: int, content: bytes) -> int:
        if len(content) < 20:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(file, content[:20])

    with Journal(path) as journal:
        journal.append({"trial": 0})
        monkeypatch.setattr(os, "write", full)
        with pytest.raises(InputError, match="No space left"):
            journal.append({"trial": 1, "commitment": 30 * "0"})
        monkeypatch.undo()
        journal.append({"trial": 2})  # of another thread, when there is room again
    assert read_journal(path)[0] == [{"trial": 0}, {"trial": 2}]


def test_commitments_stand_before_outcomes_and_the_seed_nowhere(store: Path, monkeypatch: Any) -> None:
    lines, _ = read_journal(store)
    assert [(line["trial"], "outcome" in line) for line in lines[1:]] == [
        (index, kind) for index in range(3) for kind in (False, True)
    ]
    path, seed = store.with_name("other.jsonl"), 7_046_029_254_386_353_131
    run_blind(1, seed, plan=FAST, diagnose=always_none, store=path)
    assert str(seed) not in path.read_text()
    assert check_store(path, seed=seed).outcomes
    with pytest.raises(InputError, match="a seed other than"):
        check_store(path, seed=seed - 1)


def test_a_commitment_is_on_the_disk_when_the_diagnosis_begins(tmp_path: Path) -> None:
    path, seen = tmp_path / "run.jsonl", list[list[dict[str, Any]]]()

    def seen_now(study: Path, without: tuple[str, ...]) -> Mapping[str, Any]:
        seen.append(read_journal(path)[0])
        return NONE

    result = run_blind(2, SEED, plan=FAST, diagnose=seen_now, store=path)
    for lines, outcome in zip(seen, result.outcomes, strict=True):
        assert lines[-1] == {"trial": outcome.index, "commitment": outcome.sealed.commitment}


@pytest.mark.parametrize("cut", ["commitment", "outcome", "torn outcome", "torn header", "nothing"])
def test_a_run_goes_on_where_it_was_cut(store: Path, cut: str) -> None:
    expected = records(store)
    lines = store.read_bytes().splitlines(keepends=True)
    whole = {"commitment": 4, "outcome": 5, "torn outcome": 4, "torn header": 0, "nothing": 7}[cut]
    torn = lines[whole][:50] if cut.startswith("torn") else b""
    store.write_bytes(b"".join(lines[:whole]) + torn)
    done: list[int] = []
    run_blind(
        3, SEED, plan=FAST, store=store, resume=True,
        diagnose=lambda s, w: (done.append(0), NONE)[1],
    )  # fmt: skip
    assert (
        len(done) == {"commitment": 2, "outcome": 1, "torn outcome": 2, "torn header": 3, "nothing": 0}[cut]
    )
    assert records(store) == expected


def test_more_trials_may_be_asked_for_later(store: Path) -> None:
    first = records(store)
    result = run_blind(4, SEED, plan=FAST, diagnose=always_none, store=store, resume=True)
    assert records(store)[:3] == first
    assert [o.index for o in result.outcomes] == [0, 1, 2, 3]
    fewer = run_blind(2, SEED, plan=FAST, diagnose=always_none, store=store, resume=True)
    assert [o.index for o in fewer.outcomes] == [0, 1]


def test_a_store_is_not_overwritten_without_being_told(store: Path) -> None:
    before = store.read_bytes()
    with pytest.raises(InputError, match="continue it with --resume"):
        run_blind(1, SEED, plan=FAST, diagnose=always_none, store=store)
    assert store.read_bytes() == before


def test_the_store_of_another_run_is_refused(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = store.read_bytes()

    def resume(seed: int = SEED, plan: DrawRanges = FAST) -> None:
        run_blind(3, seed, plan=plan, diagnose=always_none, store=store, resume=True)

    with pytest.raises(InputError, match="a seed other than 6"):
        resume(seed=6)
    with pytest.raises(InputError, match=r"begun with leave_out = False, now it is True"):
        resume(plan=DrawRanges(kinds=("beam",), effects=FAST.effects, pairs=0.0, outside=0.0, leave_out=True))
    monkeypatch.setattr(store_module, "__version__", "9.9")
    with pytest.raises(InputError, match=r"made by modalkit .*, this is 9\.9"):
        resume()
    assert store.read_bytes() == before


def test_two_runs_do_not_write_to_one_store(store: Path) -> None:
    pytest.importorskip("fcntl")
    with Journal(store, resume=True), pytest.raises(InputError, match="another run writes to it"):
        run_blind(3, SEED, plan=FAST, diagnose=always_none, store=store, resume=True)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "holds nothing"),
        ("what?\n", "line 1: not JSON"),
        ("{}\n", "not a store"),
        ("[]\n", "not a record"),
    ],
)
def test_what_is_no_store_is_refused(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "run.jsonl"
    path.write_text(content)
    with pytest.raises(InputError, match=message):
        check_store(path)
    with pytest.raises(InputError, match=r"run\.jsonl: cannot be read"):
        check_store(tmp_path / "no" / "run.jsonl")


@pytest.mark.parametrize(
    ("key", "value"),
    [("seed", []), ("seed", {"salt": "00"}), ("seed", {"salt": "zz", "pbkdf2_sha256": "00"}), ("plan", [])],
)
def test_a_header_that_was_changed_is_an_error_that_says_so(store: Path, key: str, value: object) -> None:
    lines, _ = read_journal(store)
    lines[0][key] = value
    store.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(InputError, match=r"run\.jsonl, line 1: .* it was changed"):
        check_store(store, seed=SEED)


def changed(lines: list[dict[str, Any]], kind: str) -> None:
    """Change what was stored of trial 1."""
    outcome = lines[4]["outcome"]
    if kind == "statement":
        outcome["statement"] = outcome["statement"].replace('"beam"', '"plate"', 1)
    elif kind == "salt":
        outcome["salt"] = "00" * 16
    elif kind == "border":  # the same bytes are hashed, but they mean something else
        outcome["salt"] += outcome["statement"][:1].encode().hex()
        outcome["statement"] = outcome["statement"][1:]
    elif kind == "commitment":
        lines[3]["commitment"] = lines[1]["commitment"]
    elif kind == "order":
        lines[3], lines[4] = lines[4], lines[3]
    elif kind == "no commitment":
        del lines[3]
    elif kind == "twice":
        lines.append(lines[4])
    elif kind == "committed again":
        lines.append(lines[3])
    elif kind == "exchanged":
        lines[4]["outcome"], lines[6]["outcome"] = lines[6]["outcome"], lines[4]["outcome"]
    elif kind == "renumbered":
        outcome["index"] = 2
    elif kind == "key":
        del outcome["salt"]


KINDS = "statement salt border commitment order|no commitment|twice|committed again|exchanged|renumbered|key"


@pytest.mark.parametrize("kind", [*KINDS.partition("|")[0].split(), *KINDS.split("|")[1:]])
def test_tampering_is_found_and_the_trial_named(
    store: Path, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lines, _ = read_journal(store)
    before = json.dumps(lines)
    changed(lines, kind)
    assert json.dumps(lines) != before
    store.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(InputError, match=r"trial 1: "):
        check_store(store)
    monkeypatch.setattr(sys, "argv", ["modalkit", "blind", "--check", str(store)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert "trial 1: " in capsys.readouterr().err


def test_an_untouched_store_passes_and_says_what_was_in_flight(
    store: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = store.read_text().splitlines(keepends=True)
    store.write_text("".join(lines[:-1]))
    monkeypatch.setattr(sys, "argv", ["modalkit", "blind", "--check", str(store), "--seed", str(SEED)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    message = capsys.readouterr().out
    assert "2 trials, each opened with the commitment published before it" in message
    assert "because the run stopped: 2" in message


RUN = """
import sys
from pathlib import Path
sys.path.insert(0, {folder!r})
import blind_stub
from modalkit.blind import DrawRanges, diagnosers, run_blind
plan = DrawRanges(kinds=("beam",), effects=("none", "E", "clamp_rotation"), pairs=0.0, outside=0.0)
with diagnosers(2, command=blind_stub.command("slow", "0.2")) as diagnose:
    run_blind(5, 5, plan=plan, workers=2, diagnose=diagnose, store=Path(sys.argv[1]), resume=True)
"""


def test_a_killed_run_loses_at_most_what_is_in_flight(tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    words = [sys.executable, "-c", RUN.format(folder=str(Path(blind_stub.__file__).parent)), str(path)]
    run = subprocess.Popen(words)
    end = time.monotonic() + 120
    while not (path.exists() and path.read_bytes().count(b'"outcome"') >= 2) and time.monotonic() < end:
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    assert run.wait() == -signal.SIGKILL
    kept = check_store(path)
    assert len(kept.outcomes) >= 2
    assert len(kept.in_flight) <= 2
    subprocess.run(words, check=True)
    done = check_store(path)
    assert sorted(done.outcomes) == list(range(5))
    assert all(done.outcomes[i].sealed == kept.outcomes[i].sealed for i in kept.outcomes)
    run_blind(5, 5, plan=FAST, diagnose=always_none, store=tmp_path / "whole.jsonl")
    assert records(path) == records(tmp_path / "whole.jsonl")


@pytest.mark.slow
def test_a_killed_command_goes_on(tmp_path: Path) -> None:
    """The real command with the real diagnosis, killed after its first trial."""
    path = tmp_path / "run.jsonl"
    options = ["--trials", "4", "--seed", "5", "--kinds", "beam", "--effects", "none,E"]
    words = [sys.executable, "-m", "modalkit", "blind", *options, "--store", str(path)]
    run = subprocess.Popen(words, stderr=subprocess.DEVNULL)
    while not (path.exists() and b'"outcome"' in path.read_bytes()):
        assert run.poll() is None
        time.sleep(0.1)
    run.kill()
    run.wait()
    kept = check_store(path).outcomes
    assert 1 <= len(kept) < 4
    subprocess.run([*words, "--resume"], check=True, capture_output=True)
    assert sorted(check_store(path, seed=5).outcomes) == [0, 1, 2, 3]
    whole = [*words[:-1], str(tmp_path / "whole.jsonl"), "--workers", "1"]
    subprocess.run(whole, check=True, capture_output=True)
    assert records(path) == records(tmp_path / "whole.jsonl")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--resume"], "needs the --store"),
        (["study.toml", "--real"], "STUDY and --real"),
        (["study.toml", "--store", "run.jsonl"], "--store cannot be used with STUDY"),
        (["study.toml", "--kinds", "beam", "--leave-out"], "--kinds, --leave-out cannot be used with STUDY"),
        (["--real", "--trials", "3"], "--trials cannot be used with --real"),
        (["--check", "run.jsonl", "--json", "out.json"], "--json cannot be used with --check"),
        (["--store", "run.jsonl", "--resume"], "resuming needs its seed"),
        (["--store", "new.jsonl", "--seed", "-1"], "--seed -1: give 0 or a positive number"),
        (["study.toml", "--trials", "-1"], "--trials -1: at least 0"),
        (["study.toml", "--workers", "0"], "--workers 0: at least 1"),
        (["study.toml", "--json", "no/out.json"], "no/out.json: cannot be written"),
        (["--figures", "run.jsonl/in"], "run.jsonl is a file; name a folder"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    store: Path,
    words: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(store.parent)
    (store.parent / "study.toml").write_text(sample_file("beam_dry/study.toml").read_text())
    monkeypatch.setattr(sys, "argv", ["modalkit", "blind", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert message in capsys.readouterr().err
    assert not (store.parent / "new.jsonl").exists()


def test_a_drawn_seed_is_told_before_the_run_where_it_will_be_needed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stated: list[str] = []
    monkeypatch.setattr(blinding.progress, "print", lambda text, **_: stated.append(text))
    first = blinding._seed(None, tmp_path / "run.jsonl", False)
    assert str(first) in stated[0]
    assert 0 <= first < 2**63
    assert blinding._seed(None, None, False) != first
    assert len(stated) == 1
    assert blinding._seed(7, tmp_path / "run.jsonl", True) == 7


@pytest.mark.parametrize("content", [b"[" * 20_000 + b"\n", b'{"a":' * 20_000 + b"\n"])
def test_a_line_nested_deeper_than_a_stack(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "run.jsonl").write_bytes(content)
    with pytest.raises(InputError, match="line 1: not JSON"):
        read_journal(tmp_path / "run.jsonl")


def test_a_file_of_another_kind_without_a_line_end_is_not_emptied(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("not ours")
    with pytest.raises(InputError, match="not a store of a run"):
        Journal(path, resume=True)
    assert path.read_text() == "not ours"
