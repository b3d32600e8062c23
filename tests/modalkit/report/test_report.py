"""The report of a diagnosis: whole, self-contained, escaped, and saying what the diagnosis says."""

from __future__ import annotations

import base64
import hashlib
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from report_pages import NOON, ROOT, Reader, complete, diagnosis_page, session_of
from test_localisation_figure import diagnosis_with

from acquisition import InputError
from modalkit.cli import main
from modalkit.output.names import in_words
from modalkit.output.summary import summary_text
from modalkit.report import Document, write_report
from modalkit.report.html import Column, element, table, text
from modalkit.report.provenance import fingerprint
from modalkit.report.sections import the_causes


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("verdict", ["named", "class", "unknown", "none"])
def test_every_verdict_has_a_report(kind: str, verdict: str, tmp_path: Path) -> None:
    diagnosis = complete(diagnosis_with(kind, verdict))
    page = diagnosis_page(diagnosis, [session_of(kind, tmp_path)], when=NOON)
    read = Reader(page)
    for line in summary_text(diagnosis):
        assert " ".join(in_words(line.partition(":")[2]).split()) in read.text
    for message in (
        "mind the <gap>",
        "a warning <of> the session",
        "plates are modelled as thin",
        "2026-03-01 12:00:00",
    ):
        assert message in read.text
    assert read.text.count("How far it closes") == 2  # its heading, and the link to it
    ids = read.values("id")
    assert len(ids) == len(set(ids))
    referred = [v[1:] for v in read.values("href")] + read.values("aria-labelledby")
    assert set(referred) <= set(ids)


def markup_of(page: str) -> str:
    """Return a page without its scripts."""
    return re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


def test_a_report_needs_no_network_and_is_small(tmp_path: Path) -> None:
    page = diagnosis_page(
        complete(diagnosis_with("beam", "named")), [session_of("beam", tmp_path)], when=NOON
    )
    assert "http" not in markup_of(page).replace("http-equiv", "")
    tags = Reader(page).tags
    assert not {"link", "iframe", "object", "base", "img"} & {tag for tag, _ in tags}
    assert all(v.startswith("#") for v in Reader(page).values("href"))
    assert not Reader(page).values("src")
    assert len(page) < 200_000


def test_the_policy_of_a_page_knows_its_one_script(tmp_path: Path) -> None:
    page = diagnosis_page(
        complete(diagnosis_with("beam", "named")), [session_of("beam", tmp_path)], when=NOON
    )
    (policy,) = (a["content"] or "" for _, a in Reader(page).tags if a.get("http-equiv"))
    (script,) = re.findall(r"<script>(.*?)</script>", page, flags=re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}' blob:;" in policy
    assert policy.startswith("default-src 'none';") and "unsafe-eval" not in policy


def test_text_of_the_user_stays_text(tmp_path: Path) -> None:
    title = "<script>alert('1')</script> & \u201cquoted\u201d $x^2$"
    session = session_of("beam", tmp_path, title=title)
    page = diagnosis_page(complete(diagnosis_with("beam", "named"), title), [session], when=NOON)
    read = Reader(page)
    assert [a for tag, a in read.tags if tag == "script" and not a] == [{}]  # our own, and no other
    assert title not in page
    assert read.text.count(title) >= 2  # the heading, and the study file


def test_tables_can_be_reached_and_read_aloud(tmp_path: Path) -> None:
    page = diagnosis_page(
        complete(diagnosis_with("beam", "named")), [session_of("beam", tmp_path)], when=NOON
    )
    tags = [tag for tag, _ in Reader(page).tags]
    assert tags.count("caption") == tags.count("table") >= 6
    assert all(a.get("scope") in {"col", "row"} for tag, a in Reader(page).tags if tag == "th")
    assert all(a.get("tabindex") == "0" for _, a in Reader(page).tags if a.get("class") == "scroll")


def test_provenance_tells_files_and_text(tmp_path: Path) -> None:
    session = session_of("beam", tmp_path)
    text = Reader(diagnosis_page(complete(diagnosis_with("beam", "none")), [session], when=NOON)).text
    for name in ("study.toml", "modes.csv"):
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() in text
    assert 'modes = "modes.csv"' in text
    (tmp_path / "modes.csv").unlink()
    text = Reader(diagnosis_page(complete(diagnosis_with("beam", "none")), [session], when=NOON)).text
    assert "no longer there" in text


def test_fingerprints_are_those_of_the_standard(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")  # FIPS 180-2, appendix B.1
    assert fingerprint(tmp_path / "abc").startswith("ba7816bf8f01cfea414140de5dae2223")


def titled(title: str) -> Document:
    return Document(title, "test", element("h1", title))


def test_a_report_stands_over_no_other_file(tmp_path: Path) -> None:
    study, report = tmp_path / "study.toml", tmp_path / "out.html"
    study.write_text("title = 'mine'\n")
    with pytest.raises(InputError, match="not a report written by modalkit"):
        write_report(study, titled("mine"))
    assert study.read_text() == "title = 'mine'\n"
    with pytest.raises(InputError, match="no such folder"):
        write_report(tmp_path / "nowhere" / "out.html", titled("lost"))
    write_report(report, titled("first"))
    write_report(report, titled("second"))
    assert "<title>second: test</title>" in report.read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.html", "study.toml"]


def test_cells_that_are_not_known_are_a_dash() -> None:
    markup = table(
        "t", [Column("a"), Column("b", lambda v: f"{v:.1f}")], [["x", float("nan")], ["<y>", 2.04]]
    ).markup
    assert "–" in markup and "2.0" in markup and "&lt;y&gt;" in markup and "nan" not in markup
    assert element("p", "a\nb", class_="q").markup == '<p class="q">a<br>b</p>'


@pytest.mark.long
def test_the_command_writes_report_and_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    study = ROOT / "sample_data" / "beam_dry" / "published.toml"

    def call(*arguments: str | Path) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["modalkit", "diagnose", str(study), *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        message = capfd.readouterr()
        return int(ended.value.code or 0), message.out, message.err

    page, folder = tmp_path / "out.html", tmp_path / "figures"
    code, out, _ = call("--report", page, "--figures", folder)
    assert code == 0
    assert f"report: {page}" in out
    assert sorted(p.stem for p in folder.iterdir()) == ["diagnosis", "gap", "localisation", "shrink"]
    read = Reader(page.read_text(encoding="utf-8"))
    summary_lines = [line for line in out.splitlines() if line.startswith(("Cause:", "Next:"))]
    assert all(" ".join(line.partition(":")[2].split()) in read.text for line in summary_lines)
    code, _, error = call("--report", study)
    assert code == 2
    assert "this command reads it" in error and study.read_text(encoding="utf-8").startswith("#")
    code, _, error = call("--report", tmp_path / "same", "--json", tmp_path / "same")
    assert code == 2
    assert "give each its own file" in error


def test_no_line_ends_within_an_arrow_or_a_power_of_ten() -> None:
    assert text("2 -> 1 with p < 1e-300") == (
        '2 <span class="one">-&gt;</span> 1 with p &lt; <span class="one">1e-300</span>'
    )
    assert text("node-3 at e-9") == "node-3 at e-9"


def test_a_cover_line_states_what_who_and_when(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made, session = complete(diagnosis_with("beam", "named")), session_of("beam", tmp_path)
    monkeypatch.delenv("MODALKIT_AUTHOR", raising=False)
    nobody = Reader(diagnosis_page(made, [session], when=NOON)).text
    what = "Diagnosis of the gap between test and model (study.toml)"
    assert f"{what} · 1 March 2026 · modalkit" in nobody
    monkeypatch.setenv("MODALKIT_AUTHOR", "B. Second")
    assert f"{what} · B. Second · 1 March 2026" in Reader(diagnosis_page(made, [session], when=NOON)).text
    signed = replace(session, study=session.study.model_copy(update={"author": "A. First"}))
    assert f"{what} · A. First · 1 March 2026" in Reader(diagnosis_page(made, [signed], when=NOON)).text


def test_without_a_gap_no_cause_is_the_marked_row() -> None:
    rows = re.findall(
        r"<tr[^>]*>.*?</tr>", the_causes(complete(diagnosis_with("beam", "none"))).markup, re.DOTALL
    )
    marked = [row for row in rows if "answer-row" in row]
    assert len(marked) == 1 and "no cause: tolerances and noise alone" in marked[0]
    assert rows.index(marked[0]) == 1  # behind the heading
