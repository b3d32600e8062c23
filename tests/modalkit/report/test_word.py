"""Reports for a word processor: all of the page's words and tables, a picture for each chart, whole or not at all."""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import docx
import pytest
from report_pages import NOON, Reader, complete, session_of
from test_localisation_figure import diagnosis_with

from acquisition import InputError
from modalkit.cli import main
from modalkit.report import Document, diagnosis_report, page, write_report
from modalkit.report.document import Section
from modalkit.report.html import Column, Raw, bullets, definitions, element, joined, table
from modalkit.report.word import word
from modalkit.views.chart import Axis, Chart, Choices, Series


def read(content: bytes) -> tuple[str, list[list[list[str]]]]:
    """Return the text of a document and the cells of its tables."""
    whole = docx.Document(BytesIO(content))
    tables = [[[cell.text for cell in row.cells] for row in t.rows] for t in whole.tables]
    return "\n".join(p.text for p in whole.paragraphs), tables


def test_every_element_of_a_report_has_its_place() -> None:
    column = Column("f [Hz]", lambda value: f"{value:.1f}")
    body = joined(
        element("p", "a <b> & c -> 1e-9\nsecond line"),
        bullets(["one", "two"]),
        definitions({"Cause": "sensor_mass"}),
        element("pre", "modalkit diagnose study.toml"),
        table("All modes.", [Column("mode"), column], [["first", 12.34], ["second", float("nan")]]),
    )
    text, tables = read(word(Document("bar", "test", element("h1", "bar"), [Section("What", [body])])))
    for words in (
        "a <b> & c -> 1e-9\nsecond line",
        "one\ntwo",
        "Cause\nsensor_mass",
        "study.toml",
        "All modes.",
    ):
        assert words in text
    assert tables == [[["mode", "f [Hz]"], ["first", "12.3"], ["second", "–"]]]


def test_a_diagnosis_for_word_has_the_words_the_tables_and_the_charts_of_the_page(tmp_path: Path) -> None:
    report = diagnosis_report(
        complete(diagnosis_with("beam", "named")), [session_of("beam", tmp_path)], when=NOON
    )
    content = word(report)
    text, tables = read(content)
    markup = Reader(page(report))
    assert len(tables) == len([tag for tag, _ in markup.tags if tag == "table"])
    charts = [part for part in report.parts() if not isinstance(part, Raw)]
    assert any(isinstance(part, Chart) for part in charts)
    assert len(docx.Document(BytesIO(content)).inline_shapes) == len(charts)
    for section in report.shown:
        assert section.title in text
    assert "Drag" not in text and "mind the <gap>" in text


def test_a_chart_of_many_choices_is_drawn_with_the_first() -> None:
    lines = [("1+Z / 1+Z, the worst", [Series("a", "line", None, [3.0, 4.0], "blue")]), ("2+Z / 1+Z", [])]
    chart = Chart("c", "title", "Magnitude.", Axis("f"), Axis("H"), choices=Choices("FRF", lines, [1.0, 2.0]))
    shown = chart.on_paper()
    assert shown.text == "FRF 1+Z / 1+Z, the worst. Magnitude." and shown.choices is None
    assert list(shown.series[0].x or ()) == [1.0, 2.0]
    assert shown.on_paper() is shown


def test_a_word_file_stands_over_no_other_file(tmp_path: Path) -> None:
    foreign, own = tmp_path / "letter.docx", tmp_path / "own.docx"
    letter = docx.Document()
    letter.save(str(foreign))
    before = foreign.read_bytes()
    report = Document("bar", "test", element("h1", "bar"))
    with pytest.raises(InputError, match="not a report written by modalkit"):
        write_report(foreign, report)
    assert foreign.read_bytes() == before
    write_report(own, report)
    write_report(own, report)
    assert docx.Document(str(own)).core_properties.title == "bar: test"


def test_without_the_library_a_command_refuses_before_it_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    session_of("beam", tmp_path)
    monkeypatch.setitem(sys.modules, "docx", None)
    wanted = tmp_path / "out.docx"
    arguments = ["modalkit", "diagnose", str(tmp_path / "study.toml"), "--report", str(wanted)]
    monkeypatch.setattr(sys, "argv", arguments)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    message = " ".join(capsys.readouterr().err.split())
    assert "modalkit-ema[word]" in message and "written by docx" in message
    assert not wanted.exists()
