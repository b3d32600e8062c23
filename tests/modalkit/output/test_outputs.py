"""No command replaces a file that it reads, nor one that is not of the kind it writes."""

from __future__ import annotations

import inspect
import json
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from acquisition import Dof, InputError, ModalData
from modalkit import Modes, read, write_modes
from modalkit.cli import main
from modalkit.cli.on_demand import ENTRIES, loaded
from modalkit.figures import save_figures
from modalkit.output.destinations import check_output, check_outputs, json_of, store_of, table_of, uff_of
from modalkit.output.whole import write_json
from modalkit.workers.journal import Journal

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
Refused = Callable[..., str]

COMMANDS: dict[str, tuple[str, ...]] = {
    "inspect --write-layout": ("inspect", "test.uff"),
    "frf --output": ("frf", "test.uff"),
    "identify --output": ("identify", "test.uff"),
    "identify --json": ("identify", "study.toml"),
    "identify --report": ("identify", "study.toml"),
    "correlate --json": ("correlate", "study.toml"),
    "localise --json": ("localise", "study.toml"),
    "tables --output": ("tables",),
    "update --json": ("update", "study.toml"),
    "update --report": ("update", "study.toml"),
    "diagnose --json": ("diagnose", "study.toml"),
    "diagnose --report": ("diagnose", "study.toml"),
    "effects --json": ("effects",),
    "simulate --output": ("simulate", "study.toml"),
    "blind --json": ("blind", "study.toml"),
    "blind --report": ("blind", "study.toml"),
    "blind --markdown": ("blind",),
    "blind --store": ("blind", "--resume", "--seed", "1"),
    "batch --output": ("batch", "."),
    "part --json": ("part", "study.toml"),
}
"""Every option that names a file to write, by a command that has it; folders are below."""
FOLDERS = {"--figures", "--json-dir"}
READ = {"layout", "file", "data", "check", "files", "other", "rules", "study", "studies", "folder"}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder, which is the current one, with a study and files of every kind."""
    shutil.copytree(SAMPLES / "beam_wet", tmp_path, dirs_exist_ok=True)
    (tmp_path / "beam_wet.uff").rename(tmp_path / "test.uff")
    for study in ("study.toml", "published.toml"):
        text = (tmp_path / study).read_text(encoding="utf-8").replace("beam_wet.uff", "test.uff")
        (tmp_path / study).write_text(text, encoding="utf-8")
    (tmp_path / "other.uff").write_text("    -1\n   151\nours\nNONE\nanother program\n\n", encoding="ascii")
    (tmp_path / "other.json").write_text('{"name": "package"}', encoding="utf-8")
    (tmp_path / "other.csv").write_text("name,mail\nA,a\n", encoding="utf-8")
    (tmp_path / "by_hand.csv").write_text("frequency,sigma,damping\n10.5,0.01,0.002\n", encoding="utf-8")
    (tmp_path / "one line").write_text("all of a thesis, in one line", encoding="utf-8")
    (tmp_path / "page.html").write_text("<!doctype html>\n<html><body>mine</body></html>", encoding="utf-8")
    (tmp_path / "README.md").write_text("# Mine\n", encoding="utf-8")
    (tmp_path / "link").symlink_to("study.toml")
    os.link(tmp_path / "test.uff", tmp_path / "hard.uff")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def refused(folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Refused:
    """Return a function that runs a command, sees that it changed nothing, and returns what it said."""

    def call(*words: str) -> str:
        before = contents(folder)
        monkeypatch.setattr(sys, "argv", ["modalkit", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        message = capfd.readouterr().err.strip()
        assert ended.value.code == 2, words
        assert contents(folder) == before, words
        return message

    return call


def contents(folder: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_every_option_that_names_a_file_to_write_is_examined_here() -> None:
    found = set()
    for entry in ENTRIES:
        command = loaded(entry.module)[entry.name]
        hints = get_type_hints(inspect.unwrap(command.callback))
        for parameter in command.params:
            option = max(parameter.opts, key=len)
            if "Path" in str(hints.get(parameter.name)) and parameter.name not in READ | {"help"}:
                found |= {f"{entry.name} {option}"} if option not in FOLDERS else set()
    assert found == set(COMMANDS)


@pytest.mark.parametrize("place", ["study.toml", "link", "one line", "other.json", "other.csv", "README.md"])
@pytest.mark.parametrize("option", COMMANDS)
def test_nothing_is_replaced_but_what_the_command_itself_writes(
    refused: Refused, option: str, place: str
) -> None:
    message = refused(*COMMANDS[option], option.split()[1], place)
    assert place in message
    assert "name another" in message or "a table ends in" in message


@pytest.mark.parametrize(
    "words",
    [
        "identify test.uff -o test.uff",
        "identify test.uff -o hard.uff",
        "identify study.toml -o test.uff",
        "identify test.uff -o other.csv",
        "identify test.uff -o other.json",
        "identify test.uff -o by_hand.csv",
        "identify published.toml -o modes.csv",
        "frf test.uff -o ./test.uff",
        "frf test.uff -o other.uff",
        "simulate study.toml -o test.uff",
        "batch . -o modes.csv",
        "batch . -o other.csv",
        "diagnose study.toml --report page.html",
        "tables -o /dev/null",
    ],
)
def test_inputs_and_files_of_others_stay(refused: Refused, words: str) -> None:
    message = refused(*words.split())
    assert "name another file" in message or "name one" in message


def test_the_message_says_what_to_type(refused: Refused) -> None:
    assert refused("identify", "test.uff", "-o", "study.toml").endswith(
        "the ending states the format, .bunv, .uf, .uff, .unv, .csv, .json; name another file, as study_modes.uff"
    )
    assert refused("frf", "test.uff", "-o", "test.uff").endswith(
        "test.uff: this command reads it; name another file, as test_frfs.uff"
    )


def test_one_file_is_not_asked_for_twice(refused: Refused) -> None:
    twice = "given for two different results"
    assert twice in refused("diagnose", "study.toml", "--json", "new", "--report", "./new")
    assert twice in refused("identify", "test.uff", "--json", "new.json", "-o", "./new.json")


def test_a_batch_does_not_touch_the_tables_and_results_of_others(refused: Refused, folder: Path) -> None:
    (folder / "t_causes.csv").write_text("why,who\n", encoding="utf-8")
    assert "t_causes.csv: exists" in refused("batch", ".", "-o", "t.csv")
    (folder / "t_causes.csv").unlink()
    (folder / "t.csv.jsonl").write_text('{"finished":true}\n', encoding="utf-8")
    assert "t.csv.jsonl: exists" in refused("batch", ".", "-o", "t.csv")
    (folder / "t.csv.jsonl").unlink()
    (folder / "study.json").write_text('{"mine": 1}', encoding="utf-8")
    assert "study.json: exists" in refused("batch", ".", "-o", "t.csv", "--json-dir", ".")


def test_figures_replace_figures_only(tmp_path: Path) -> None:
    save_figures({"one": Figure()}, tmp_path)
    save_figures({"one": Figure()}, tmp_path)
    (tmp_path / "two.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"photograph" * 99)
    with pytest.raises(InputError, match=r"two\.png: exists and is not a figure drawn by modalkit"):
        save_figures({"one": Figure(), "two": Figure()}, tmp_path)
    assert b"photograph" in (tmp_path / "two.png").read_bytes()


@pytest.mark.parametrize("content", ['{"a":1}', "one line", '{"schema":"other"}\n{"torn'])
def test_a_journal_cuts_nothing_off_the_file_of_another(tmp_path: Path, content: str) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match="not a store of a run"):
        Journal(path, resume=True)
    assert path.read_text(encoding="utf-8") == content


@pytest.mark.parametrize("torn", [b"{", b'{"schema":"modalkit.blindrun/2","ver'])
def test_a_store_that_was_torn_in_its_first_line_is_begun_anew(tmp_path: Path, torn: bytes) -> None:
    path = tmp_path / "store.jsonl"
    path.write_bytes(torn)
    check_outputs((path, store_of("modalkit.blindrun/2")))
    with Journal(path, resume=True) as journal:
        assert journal.found == ()


def test_what_a_command_wrote_before_is_replaced(tmp_path: Path) -> None:
    one = tmp_path / "a.json"
    write_json(one, {"schema": "modalkit.modes/1"})
    write_json(one, {"schema": "modalkit.modes/2", "modes": []})
    assert json.loads(one.read_text()) == {"schema": "modalkit.modes/2", "modes": []}
    with pytest.raises(InputError, match=r"a\.json: exists and is not a JSON file of modalkit\.update"):
        write_json(one, {"schema": "modalkit.update/1"})
    (tmp_path / "empty").touch()
    check_output(tmp_path / "empty", json_of("modalkit.update/1"))
    check_output(SAMPLES / "beam_wet" / "beam_wet.uff", uff_of("frfs"))


@pytest.mark.long
def test_a_parquet_table_is_known_by_its_columns(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    pd.DataFrame({"study": ["a"], "title": ["b"]}).to_parquet(tmp_path / "ours.parquet")
    pd.DataFrame({"name": ["a"], "mail": ["b"]}).to_parquet(tmp_path / "other.parquet")
    (tmp_path / "short.parquet").write_bytes(b"PAR1")
    kind = table_of(["study", "title", "verdict"], ".parquet")
    check_output(tmp_path / "ours.parquet", kind)
    for name in ("other.parquet", "short.parquet"):
        with pytest.raises(InputError, match=name):
            check_output(tmp_path / name, kind)


def test_a_file_that_may_not_be_written_is_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.json"
    write_json(path, {"schema": "modalkit.modes/1"})
    monkeypatch.setattr("os.access", lambda place, mode: Path(place) != path)
    with pytest.raises(InputError, match=r"a\.json: is read-only"):
        write_json(path, {"schema": "modalkit.modes/1"})


@pytest.mark.parametrize("ending", [".uff", ".csv", ".json"])
def test_modes_replace_modes_written_before(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"a{ending}"
    for frequency in (5.0, 6.0):
        write_modes(
            path,
            Modes(
                ModalData(
                    frequency=np.array([frequency]),
                    frequency_sigma=np.array([0.1]),
                    dofs=(Dof(1, 3),),
                    shapes=np.ones((1, 1)),
                )
            ),
        )
        assert read(path).modal.frequency == pytest.approx([frequency])


def test_modes_without_shapes_are_not_written_as_what_cannot_hold_them(tmp_path: Path) -> None:
    modes = Modes(ModalData(frequency=np.array([5.0]), frequency_sigma=np.array([0.1])))
    with pytest.raises(InputError, match=r"write them as \.csv or \.json"):
        write_modes(tmp_path / "a.uff", modes)
    for name in ("a.csv", "a.json"):
        write_modes(tmp_path / name, modes)
        write_modes(tmp_path / name, modes)
        assert read(tmp_path / name).modal.frequency == pytest.approx([5.0])
