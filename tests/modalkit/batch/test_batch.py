"""A folder of studies: what is found, what comes out, what is skipped, and that nothing is lost."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from acquisition.errors import InputError
from modalkit import cli
from modalkit.batch import BatchResult, Part, find_studies, part_document, tables, write_tables
from modalkit.batch import run as batch_run
from modalkit.batch.find import Found
from modalkit.batch.run import run_batch
from modalkit.batch.writing import table_places
from modalkit.output.destinations import check_outputs

pytestmark = pytest.mark.long

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"
MODES = """
[test]
modes = "modes.csv"
"""


@pytest.fixture
def fleet(tmp_path: Path) -> Path:
    return make_fleet(tmp_path / "fleet")


def make_fleet(folder: Path) -> Path:
    """Two studies that work, deep in folders, two that do not, and what is not a study."""
    shutil.copytree(SAMPLES / "beam_dry", folder / "b" / "beam")
    study = folder / "b" / "beam" / "published.toml"
    (folder / "b" / "beam" / "study.toml").unlink()
    text = study.read_text()
    study.write_text(text if "[update]" in text else text + '\n[update]\nparameters = ["E"]\n')
    (folder / "b" / "beam" / "alone.toml").write_text(MODES)
    (folder / "a_broken.toml").write_text("[test\n")
    (folder / "misspelt.toml").write_text('[test]\nfile = ["x.uff"]\n')
    (folder / "settings.toml").write_text("[tool]\nx = 1\n")
    (folder / ".hidden").mkdir()
    (folder / ".hidden" / "study.toml").write_text(MODES)
    return folder


NAMES = ["a_broken.toml", "b/beam/alone.toml", "b/beam/published.toml", "misspelt.toml"]


def modalkit(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["modalkit", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_studies_are_found_in_order_and_nothing_else(fleet: Path) -> None:
    assert [found.name for found in find_studies(fleet)] == NAMES


def test_the_digest_changes_with_every_file_a_study_names(fleet: Path) -> None:
    def digests() -> dict[str, str]:
        return {found.name: found.digest for found in find_studies(fleet)}

    first = digests()
    assert digests() == first
    data = fleet / "b" / "beam" / "modes.csv"
    data.write_text(data.read_text() + "\n")
    changed = {name for name, digest in digests().items() if digest != first[name]}
    assert changed == {"b/beam/alone.toml", "b/beam/published.toml"}


def test_an_empty_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no study in it"):
        find_studies(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        find_studies(tmp_path / "missing")
    (tmp_path / "study.txt").touch()
    with pytest.raises(InputError, match="is a file; name the folder"):
        find_studies(tmp_path / "study.txt")


def test_a_scheduler_that_does_not_answer_leaves_no_store(tmp_path: Path) -> None:
    store = tmp_path / "table.csv.jsonl"
    with pytest.raises(InputError, match="not an address"):
        run_batch((Found("a", tmp_path / "a.toml", ""),), scheduler="head", store=store)
    assert not store.exists()


def test_a_part_is_what_the_single_commands_say(fleet: Path, tmp_path: Path, monkeypatch: Any) -> None:
    study = fleet / "b" / "beam" / "published.toml"
    record = json.loads(json.dumps(_plain(part_document(study))))
    for command, key in (("update", "update"), ("diagnose", "diagnosis")):
        out = tmp_path / f"{command}.json"
        assert modalkit(monkeypatch, command, study, "--json", out) == 0
        single = json.loads(out.read_text())
        single.pop("warnings")
        record[key].pop("warnings")
        assert record[key] == single
    published = pd.read_csv(study.with_name("modes.csv"), comment="#")["frequency"].tolist()
    assert [mode["frequency_hz"] for mode in record["modes"]] == published


def _plain(value: Any) -> Any:
    from modalkit.output.whole import plain

    return plain(value)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The fleet, and the store of a batch that has come to its end."""
    folder = tmp_path_factory.mktemp("batch")
    fleet, store = make_fleet(folder / "fleet"), folder / "store.jsonl"
    run_batch(find_studies(fleet), store=store)
    return fleet, store


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_a_folder_in_tables_out(
    stored: tuple[Path, Path],
    tmp_path: Path,
    ending: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    table, parts = tmp_path / f"table.{ending}", tmp_path / "parts"
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    fleet, store = stored
    shutil.copy(store, tmp_path / f"table.{ending}.jsonl")
    assert (
        modalkit(monkeypatch, "batch", fleet, "-o", table, "--json-dir", parts, "--resume", "--workers", 1)
        == 0
    )
    message = capsys.readouterr().out
    assert "skipped: a_broken.toml: not a valid TOML file" in message
    assert "skipped: misspelt.toml: unknown key test.file" in message
    read: Callable[[Path], pd.DataFrame] = pd.read_parquet if ending == "parquet" else pd.read_csv
    main = read(table).set_index("study")
    assert main.index.tolist() == NAMES[1:3]
    record = json.loads((parts / "b" / "beam" / "published.json").read_text())
    row, diagnosis = main.loc["b/beam/published.toml"], record["diagnosis"]
    assert row["verdict"] == diagnosis["cause"]["verdict"]
    assert row["gap_before_percent"] == pytest.approx(diagnosis["shrink"]["before_percent"])
    assert row["f1_hz"] == pytest.approx(record["modes"][0]["frequency_hz"])
    assert pd.isna(main.loc["b/beam/alone.toml", "verdict"])
    causes = read(tmp_path / f"table_causes.{ending}")
    assert causes["rank"].nunique() == len(diagnosis["cause"]["ranking"])
    factors = read(tmp_path / f"table_factors.{ending}")
    assert factors["value"].tolist() == pytest.approx([p["value"] for p in record["update"]["parameters"]])
    assert len(read(tmp_path / f"table_modes.{ending}")) == 2 * len(record["modes"])
    assert read(tmp_path / f"table_skipped.{ending}")["study"].tolist() == [NAMES[0], NAMES[3]]


def test_where_nothing_works_the_code_is_2_and_no_table_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "fleet"
    folder.mkdir()
    (folder / "a.toml").write_text("[test\n")
    table = tmp_path / "table.csv"
    assert modalkit(monkeypatch, "batch", folder, "-o", table) == 2
    assert "none of 1 study file worked" in capsys.readouterr().err
    assert not table.exists()


class Fake:
    """A warm process that knows the answers, and counts the questions."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[str] = []
        self.stop_at = ""
        monkeypatch.setattr(batch_run, "run_part", self)

    def __call__(self, found: Any, run: Any) -> Part:
        if found.name == self.stop_at:
            raise KeyboardInterrupt
        self.asked.append(found.name)
        broken = "broken" in found.name
        record = {"title": found.name, "modes": [], "update": None, "update_failure": None, "diagnosis": None}
        return Part(
            found.name, found.digest, None if broken else record | {"warnings": []}, "no" if broken else None
        )


def test_an_interrupted_batch_goes_on_and_repeats_what_failed_or_changed(
    fleet: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake, store = Fake(monkeypatch), tmp_path / "store.jsonl"

    def run(resume: bool = True) -> BatchResult:
        fake.asked.clear()
        return run_batch(find_studies(fleet), store=store, resume=resume)

    fake.stop_at = NAMES[2]
    with pytest.raises(KeyboardInterrupt):
        run(resume=False)
    assert fake.asked == NAMES[:2]
    fake.stop_at = ""
    with pytest.raises(InputError, match="continue it with --resume"):
        run(resume=False)
    whole = run()
    assert fake.asked == [NAMES[0], *NAMES[2:]]
    assert [part.name for part in whole.parts] == NAMES
    assert run() == whole
    assert fake.asked == NAMES[:1]
    (fleet / "misspelt.toml").write_text(MODES)
    run()
    assert fake.asked == [NAMES[0], NAMES[3]]
    run(resume=False)  # it had come to its end, so it is begun anew
    assert fake.asked == NAMES


def test_columns_and_types_do_not_depend_on_what_is_in_them(tmp_path: Path) -> None:
    empty = tables(BatchResult(()))
    record = {
        "title": "t",
        "modes": [],
        "update": None,
        "update_failure": None,
        "diagnosis": None,
        "warnings": [],
    }
    one = tables(BatchResult((Part("a.toml", "", record, None), Part("b.toml", "", None, "no"))))
    for name, table in empty.items():
        assert table.dtypes.equals(one[name].dtypes)
    assert one[""]["study"].tolist() == ["a.toml"]
    assert one["skipped"]["message"].tolist() == ["no"]


def test_tables_are_written_all_or_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "table.csv"
    path.write_text("study,title\nold")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    frames = tables(BatchResult((Part("b.toml", "", None, "no"),)))
    monkeypatch.setattr(pd.DataFrame, "to_csv", full)
    with pytest.raises(InputError, match="No space left"):
        write_tables(path, frames)
    assert [p.name for p in tmp_path.iterdir()] == ["table.csv"]
    assert path.read_text() == "study,title\nold"


@pytest.mark.parametrize(
    ("name", "message"), [("table.xlsx", r"ends in \.csv or"), ("no/table.csv", "no such folder")]
)
def test_a_table_without_a_place_is_refused(tmp_path: Path, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_outputs(*table_places(tmp_path / name))


def test_a_missing_extra_is_an_error_that_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"modalkit-ema\[parquet\]"):
        table_places(tmp_path / "table.parquet")


def test_a_changed_result_is_not_taken_up(tmp_path: Path) -> None:
    store = tmp_path / "run.jsonl"
    part = batch_run.Part("a/study.toml", "0" * 64, {"modes": [{"frequency_hz": 12.5}]}, None)
    lines = [{"schema": batch_run.SCHEMA, "version": batch_run.__version__}, batch_run._line(part)]
    text = "".join(json.dumps(line) + "\n" for line in lines)
    store.write_text(text)
    assert run_batch((), store=store, resume=True).parts == ()
    store.write_text(text.replace("12.5", "13.5"))
    with pytest.raises(InputError, match=r"the result of a/study\.toml was changed"):
        run_batch((), store=store, resume=True)
