"""Which commands write a report: identify, update, diagnose and blind STUDY; each says what its lines say."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from report_pages import Reader, data_of

from acquisition.quantities import decimals
from modalkit.cli import main

BEAM = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry"
Call = Callable[..., tuple[int, str, str]]


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Call:
    def run(*arguments: str | Path) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["modalkit", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capfd.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return run


@pytest.mark.parametrize("source", ["study.toml", "beam_dry.uff", "modes.csv"])
def test_identify_reports_modes_of_studies_files_and_tables(call: Call, tmp_path: Path, source: str) -> None:
    page, record = tmp_path / "modes.html", tmp_path / "modes.json"
    code, out, error = call("identify", BEAM / source, "--report", page, "--json", record)
    assert (code, f"report: {page}" in out) == (0, True), error
    read = Reader(page.read_text(encoding="utf-8"))
    modes = json.loads(record.read_text(encoding="utf-8"))["modes"]
    digits = max(decimals(mode["frequency_sigma_hz"]) or 0 for mode in modes)
    for mode in modes:
        assert f"{mode['frequency_hz']:.{digits}f}" in read.text
    assert f"modalkit identify {BEAM / source} --report {page}" in read.text
    names = {chart["name"] for chart in data_of(page.read_text(encoding="utf-8"))["charts"]}
    assert ("poles" in names) is (source != "modes.csv")
    assert ("mac" in names) is (source == "study.toml")


@pytest.mark.long
def test_modes_named_by_hand_are_so_in_report_and_figure(call: Call, tmp_path: Path) -> None:
    page = tmp_path / "modes.html"
    code, _, error = call("identify", BEAM / "study.toml", "--drop", "154", "--report", page)
    assert code == 0, error
    charts = {chart["name"]: chart for chart in data_of(page.read_text(encoding="utf-8"))["charts"]}
    assert "dropped by hand" in {one["name"] for one in charts["poles"]["series"]}


@pytest.mark.long
def test_update_reports_what_it_prints(call: Call, tmp_path: Path) -> None:
    page, record = tmp_path / "update.html", tmp_path / "update.json"
    code, out, error = call("update", BEAM / "study.toml", "--report", page, "--json", record)
    assert code == 0, error
    read = Reader(page.read_text(encoding="utf-8"))
    (parameter,) = json.loads(record.read_text(encoding="utf-8"))["parameters"]
    assert f"{parameter['factor']:.4f}" in read.text
    before, after = out.splitlines()[0].split(": ")[1].split(" r.m.s.")[0].split(" -> ")
    assert f"{before} → {after} r.m.s." in read.text
    assert {"gap", "factors", "frf", "poles", "mac"} <= {
        chart["name"] for chart in data_of(page.read_text(encoding="utf-8"))["charts"]
    }


@pytest.mark.long
def test_a_plan_reports_its_lines(call: Call, tmp_path: Path) -> None:
    page = tmp_path / "plan.html"
    code, out, error = call("blind", BEAM / "study.toml", "--report", page)
    assert code == 0, error
    text = Reader(page.read_text(encoding="utf-8")).text
    tells = next(line for line in out.splitlines() if line.startswith("Pairs:"))
    assert " ".join(tells.removeprefix("Pairs:").split()) in text
    charts = {chart["name"] for chart in data_of(page.read_text(encoding="utf-8"))["charts"]}
    assert charts == {"separations", "thresholds"}


def test_what_has_no_report_says_so_before_it_begins(call: Call, tmp_path: Path) -> None:
    code, _, error = call("blind", "--trials", "1", "--report", tmp_path / "x.html")
    assert code == 2 and "--report needs a STUDY" in error
    (tmp_path / "mine.html").write_text("mine", encoding="utf-8")
    code, _, error = call("identify", BEAM / "study.toml", "--report", tmp_path / "mine.html")
    assert code == 2 and "not a report written by modalkit" in error
    assert (tmp_path / "mine.html").read_text(encoding="utf-8") == "mine"
