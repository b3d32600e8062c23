"""The report of a diagnosis: whole, self-contained, escaped, and saying what the diagnosis says."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import sys
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from figure_cases import case_of, model_of
from figure_text import assert_legible
from test_localisation_figure import diagnosis_with

from acquisition import Dof, FrfSet, InputError
from modalkit.cli import main
from modalkit.figures.diagnosis.all import Drawing, drawings
from modalkit.output.names import in_words
from modalkit.output.summary import summary_text
from modalkit.report import Document, diagnosis_report, write_report
from modalkit.report.html import Column, element, table, text
from modalkit.report.page import page as html
from modalkit.report.provenance import fingerprint
from modalkit.report.sections import the_causes
from modalkit.study.read import Study, read_study
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.fitted import fitted
from modalkit.workflow.overlaid import LINES, selected_lines
from updating import Diagnosis
from updating.diagnosis.answer.closing import HeldPoints, Shrink
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked
from updating.diagnosis.answer.result import Gap
from updating.effects import Lack, Obstacle

NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)
ROOT = Path(__file__).resolve().parents[3]
VOID = {"meta", "br", "img"}
SCRIPTS = {"style", "script"}


class Reader(HTMLParser):
    """Reads a page, and fails where its elements do not nest."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(page)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not SCRIPTS & set(self.open):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())

    def values(self, name: str) -> list[str]:
        return [v for _, attributes in self.tags for k, v in attributes.items() if k == name and v]


def session_of(kind: str, folder: Path, *, title: str = "A case") -> Session:
    path = folder / "study.toml"
    path.write_text(f'title = """{title}"""\n[test]\nmodes = "modes.csv"\n', encoding="utf-8")
    (folder / "modes.csv").write_text("frequency\n20\n", encoding="utf-8")
    study: Study = read_study(path)
    return Session(
        study, replace(case_of(kind, factor=0.95), title=title), None, None, ("a warning <of> the session",)
    )


def complete(diagnosis: Diagnosis, title: str = "A case") -> Diagnosis:
    """Give a diagnosis made by hand what a real one has."""
    modes = diagnosis.gap.modes.assign(
        study=title, MAC=0.99, **{"model [Hz]": 100.0, "test damping": 0.01, "model damping": np.nan}
    )
    modes.index = pd.RangeIndex(1, len(modes) + 1, name="mode")
    gap = Gap(modes, 3.2, 0.1, np.ones(3))
    out = {
        "shear": Obstacle(Lack.MODEL, "plates are modelled as thin"),
        "damping_patch": Obstacle(Lack.EXPECTATION, "nothing says what damping to expect"),
    }
    return replace(diagnosis, title=title, gap=gap, not_examined=out, warnings=("mind the <gap>",))


def diagnosis_page(diagnosis: Diagnosis, sessions: Sequence[Session], *, when: datetime) -> str:
    """Return the report of a diagnosis as HTML."""
    return html(diagnosis_report(diagnosis, sessions, when=when))


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


def data_of(page: str) -> dict[str, Any]:
    """Return what the figures of a page are made of."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, flags=re.DOTALL)
    assert found is not None
    return json.loads(found[1])


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


@pytest.mark.long
def test_every_figure_has_its_place_its_words_and_its_data(tmp_path: Path) -> None:
    page = diagnosis_page(
        complete(diagnosis_with("plate", "named")), [session_of("plate", tmp_path)], when=NOON
    )
    figures = [a for tag, a in Reader(page).tags if tag == "figure"]
    charts = data_of(page)["charts"]
    assert [a["id"] for a in figures] == [c["name"] for c in charts] == ["gap", "place", "causes", "closing"]
    for figure, chart in zip(figures, charts, strict=True):
        assert figure["aria-labelledby"] in Reader(page).values("id")
        assert chart["title"] in Reader(page).text and chart["text"] in Reader(page).text
        assert any(one["y"] or one.get("value") for one in chart["series"])


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


def test_the_answer_is_marked_with_its_interval(tmp_path: Path) -> None:
    estimate = ParameterEstimate(0.0121, "kg", 0.0115, 0.0126, False)
    row = Ranked(
        effects=("sensor_mass",),
        probability=0.97,
        equivalents=(("lumped_mass",),),
        parameters={"sensor_mass.mass": estimate},
        plausible=True,
        p_value=0.4,
    )
    made = complete(diagnosis_with("beam", "named"))
    stated = replace(made, ranking=(row, *made.ranking[1:]), sets=(("sensor_mass",),))
    page = diagnosis_page(stated, [session_of("beam", tmp_path)], when=NOON)
    marked = re.findall(r'<tr class="answer-row">.*?</tr>', page, flags=re.DOTALL)
    assert any("mass 12.1 g (11.5 to 12.6)" in r and "97 %" in r and "lumped mass" in r for r in marked)


def test_errors_of_all_data_are_told_in_standard_deviations(tmp_path: Path) -> None:
    made = complete(diagnosis_with("beam", "named"))
    shrink = Shrink(
        metric="combined",
        before=2500.0,
        after=120.0,
        held_before=2500.0,
        held_after=150.0,
        held_runner_up=None,
        held_nuisance=900.0,
        floor=100.0,
        closed=None,
        stretch=9.0,
        points=HeldPoints(40.0, 3.0, 20.0),
    )
    text = Reader(
        diagnosis_page(replace(made, shrink=shrink), [session_of("beam", tmp_path)], when=NOON)
    ).text
    assert "25 sigma" in text and "1.5 sigma" in text
    assert "40 % before, 3 % after, 20 % with the tolerances alone" in text


def test_provenance_tells_files_and_text(tmp_path: Path) -> None:
    session = session_of("beam", tmp_path)
    text = Reader(diagnosis_page(complete(diagnosis_with("beam", "none")), [session], when=NOON)).text
    for name in ("study.toml", "modes.csv"):
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() in text
    assert 'modes = "modes.csv"' in text
    (tmp_path / "modes.csv").unlink()
    text = Reader(diagnosis_page(complete(diagnosis_with("beam", "none")), [session], when=NOON)).text
    assert "not there any more" in text


def test_fingerprints_are_those_of_the_standard(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")  # FIPS 180-2, appendix B.1
    assert fingerprint(tmp_path / "abc").startswith("ba7816bf8f01cfea414140de5dae2223")


def drawn(kind: str, verdict: str, folder: Path, metric: str = "frequency") -> dict[str, Drawing]:
    made = complete(diagnosis_with(kind, verdict, points=()))
    return drawings(replace(made, shrink=replace(made.shrink, metric=metric)), [session_of(kind, folder)])  # type: ignore[arg-type]


@pytest.mark.long
@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("metric", ["frequency", "frf", "combined"])
@pytest.mark.parametrize("verdict", ["named", "unknown", "none"])
def test_figures_of_a_report_are_legible(kind: str, metric: str, verdict: str, tmp_path: Path) -> None:
    found = drawn(kind, verdict, tmp_path, metric)
    assert list(found) == ["diagnosis", "gap", "localisation", "shrink"]
    for drawing in found.values():
        assert_legible(drawing.figure)
        assert drawing.caption.endswith(".")


def test_several_specimens_have_a_gap_each(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    sessions = [
        session_of("beam", tmp_path / "a", title="first"),
        session_of("beam", tmp_path / "b", title="second"),
    ]
    own = {
        f"E.factor ({t})": ParameterEstimate(f, "-", 0.8, 1.2, False)
        for t, f in (("first", 0.9), ("second", 1.1))
    }
    row = Ranked(
        effects=("E",), probability=0.99, equivalents=(), parameters=own, plausible=True, p_value=0.4
    )  # type: ignore[arg-type]
    made = complete(replace(diagnosis_with("beam", "named"), ranking=(row,), sets=(row.effects,)), "first")
    modes = pd.concat([made.gap.modes, made.gap.modes.assign(study="second")])
    stated = replace(made, gap=replace(made.gap, modes=modes))
    read = Reader(diagnosis_page(stated, sessions, when=NOON))
    assert "first: modes of the test" in read.text and "second: modes of the test" in read.text
    assert "those of the first study, first" in read.text
    assert {"gap-title", "gap-2-title"} <= set(read.values("id"))
    best = [fitted(stated, session.case, alone=False).model() for session in sessions]
    factors = [state.factors["E"] for model in best if model is not None for state in model[1:]]
    assert factors[0] < 1 < factors[1]


@pytest.mark.long
def test_a_real_test_shows_its_frfs_before_and_after(tmp_path: Path) -> None:
    session = open_study(read_study(ROOT / "sample_data" / "beam_wet" / "study.toml"))
    made = diagnosis_with("beam", "named")
    estimates = {  # as the diagnosis has them
        "fluid_added_mass.fluid_density": ParameterEstimate(1090.0, "kg/m^3", 606.0, 1420.0, False),
        "fluid_added_mass.free_surface": ParameterEstimate(0.102, "m", 0.00628, 0.8, False),
        "fluid_added_mass.bottom": ParameterEstimate(0.0276, "m", 0.00323, 0.864, False),
    }
    row = Ranked(
        effects=("fluid_added_mass",),
        probability=0.99,
        equivalents=(),
        parameters=estimates,
        plausible=True,
        p_value=0.4,
    )
    stated = complete(replace(made, ranking=(row,), sets=(row.effects,)), session.case.title)
    page = diagnosis_page(stated, [session], when=NOON)
    found = re.search(r"median FRAC ([0-9.]+) before, ([0-9.]+) after", page)
    assert found is not None
    # the fit leaves 0.4 % in the frequencies: of resonances with 0.1 to 0.6 % of damping, 1 / (1 + (0.4 / 2 zeta)^2)
    # of the correlation, 0.2 to 0.9
    assert float(found[1]) < 0.1 and float(found[2]) > 0.2
    assert len(page) < 2_000_000
    for drawing in drawings(stated, [session]).values():
        assert_legible(drawing.figure)


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


def test_long_records_are_drawn_on_fewer_lines() -> None:
    lines = 3 * LINES - 5
    rng = np.random.default_rng(1)
    values = rng.standard_normal((1, lines)) + 1j
    dof = Dof(1, 3)
    long = FrfSet(np.linspace(1, 500, lines), values, (dof,), (dof,), coherence=np.ones((1, lines)))
    short = selected_lines(long)
    assert short.values.shape == (1, LINES - 1)
    assert short.values[0, 7] == values[0, 21]
    assert short.frequency[7] == long.frequency[21]
    assert selected_lines(short) is short


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


def test_shapes_are_a_picture_on_paper() -> None:
    page = model_of(3).animate().page
    assert re.search(r'<img class="paper" alt="[^"]+" src="data:image/png;base64,iVBOR', page)
    style = page[page.index("@media print") : page.index("</style>")]
    assert ".space, .screen { display: none; }" in style and ".paper { display: block;" in style
